"""The order of rooms: imports go one way, and slow packages wait until they are needed."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "cutis"
TESTS = ROOT / "tests"

ROOMS = (
    "kernels",
    "optics",
    "transport",
    "colour",
    "albedo",
    "inverse",
    "textures",
    "spectra",
    "maps",
    "looks",
    "luts",
    "report",
    "checks",
    "render",
    "jobs",
    "studio",
    "apps",
)
"""A room may import itself, those before it and SHARED."""
SHARED = {"arrays", "errors", "moved"}
"""Modules of the package's root that every room may import; they import no room."""
SLOW = {
    "torch": {"inverse.training"},
    "colour": set(),
    "jinja2": set(),
    "matplotlib": set(),
    "onnx": set(),
    "onnxruntime": set(),
}
"""Packages imported only inside functions, and the modules exempt from that."""
CHOSEN = {"Tissue", "AlbedoSpace", "SpectralTable", "KubelkaMunkSkin", "Model"}
"""What nobody below `maps` chooses for others; `maps.defaults` says what users get."""
NOT_ROOMS = {"data"}
TESTS_OF_NO_ROOM = {"benchmarks", "studies", "validation"}


def module_name(path: Path, package: Path) -> str:
    """`optics/tissue.py` → `optics.tissue`, `optics/__init__.py` → `optics`, root → ''."""
    parts = path.relative_to(package).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(tree: ast.AST, in_function: bool = False) -> Iterator[tuple[ast.stmt, bool]]:
    """Every import statement below `tree`, and whether it waits for a call."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node, in_function
        else:
            deferred = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            yield from imports(node, in_function or deferred)


def targets(node: ast.stmt, path: Path, package: Path) -> list[str]:
    """Absolute dotted names that an import statement asks for; `from a import b` gives a.b."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    assert isinstance(node, ast.ImportFrom)
    base = node.module or ""
    if node.level:
        folders = ["cutis", *path.parent.relative_to(package).parts]
        folders = folders[: len(folders) - node.level + 1]
        base = ".".join([*folders, *([node.module] if node.module else [])])
    return [f"{base}.{alias.name}" for alias in node.names]


def allowed(module: str) -> set[str] | None:
    """First names below `cutis` that a module may import; None for any."""
    room = module.partition(".")[0]
    if room in ("", "__main__"):
        return None
    if room in ROOMS:
        return {*ROOMS[: ROOMS.index(room) + 1], *SHARED}
    return SHARED if room in SHARED else set()


def violations(path: Path, package: Path = PACKAGE) -> list[str]:
    """Lines of one module that break the order of rooms or import a slow package too early."""
    module = module_name(path, package)
    may_import = allowed(module)
    found = []
    for node, deferred in imports(ast.parse(path.read_text("utf-8"), filename=str(path))):
        where = f"{path.relative_to(package)}:{node.lineno}"
        for target in targets(node, path, package):
            top, _, below = target.partition(".")
            if top == "cutis" and may_import is not None:
                room = below.partition(".")[0]
                if room not in may_import:
                    found.append(f"{where} imports cutis.{room}, which is not below {module}")
            elif top in SLOW and not deferred and module not in SLOW[top]:
                found.append(f"{where} imports {top} outside a function")
    return found


def silent_choices(path: Path, package: Path = PACKAGE) -> list[str]:
    """Arguments and fields below `maps` that stand for a tissue or model when none is named."""
    module = module_name(path, package)
    room = module.partition(".")[0]
    if room not in ROOMS or ROOMS.index(room) >= ROOMS.index("maps"):
        return []
    found = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"), filename=str(path))):
        pairs: list[tuple[ast.expr | None, ast.expr | None]] = []
        if isinstance(node, ast.arguments):
            places = [*node.posonlyargs, *node.args]
            given = [None] * (len(places) - len(node.defaults)) + node.defaults
            pairs = [(a.annotation, d) for a, d in zip(places, given, strict=True)]
            pairs += [
                (a.annotation, d) for a, d in zip(node.kwonlyargs, node.kw_defaults, strict=True)
            ]
        elif isinstance(node, ast.ClassDef):
            pairs = [(s.annotation, s.value) for s in node.body if isinstance(s, ast.AnnAssign)]
        for annotation, default in pairs:
            if annotation is not None and default is not None:
                words = set(re.findall(r"\w+", ast.unparse(annotation)))
                if words & CHOSEN:
                    found.append(f"{path.relative_to(package)}: {ast.unparse(annotation)}")
    return found


def modules() -> list[Path]:
    return sorted(path for path in PACKAGE.rglob("*.py") if "data" not in path.parts)


def folders(parent: Path) -> set[str]:
    """Names of the folders that hold Python files."""
    return {p.name for p in parent.iterdir() if p.is_dir() and any(p.glob("*.py"))}


def test_imports_keep_the_order_of_rooms():
    found = [line for path in modules() for line in violations(path)]
    assert modules()
    assert not found, "\n".join(found)


def test_nothing_below_maps_has_a_tissue_or_model_of_its_own():
    found = [line for path in modules() for line in silent_choices(path)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("file", "source", "count"),
    [
        ("inverse/a.py", "def f(rgb: Rows, tissue: Tissue = ALIAGA2022): ...", 1),
        ("albedo/a.py", "def f(*, space: AlbedoSpace | None = None): ...", 1),
        ("albedo/a.py", "class A:\n    tissue: Tissue = ALIAGA2022", 1),
        ("inverse/a.py", "def f(rgb: Rows, tissue: Tissue, count: int = 3): ...", 0),
        ("maps/a.py", "def f(tissue: Tissue | None = None): ...", 0),
    ],
)
def test_silent_choices_are_seen(tmp_path, file, source, count):
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text(source)
    assert len(silent_choices(path, tmp_path)) == count


def test_every_folder_is_a_room():
    assert folders(PACKAGE) - NOT_ROOMS <= set(ROOMS)


def test_tests_mirror_the_rooms():
    tested, built = folders(TESTS) - TESTS_OF_NO_ROOM, folders(PACKAGE) - NOT_ROOMS
    assert tested - built == set(), "tests of no room"
    assert built - tested == set(), "rooms without tests"


@pytest.mark.parametrize(
    ("file", "source", "count"),
    [
        # upward, in every spelling
        ("optics/a.py", "from cutis.maps import SkinMaps", 1),
        ("optics/a.py", "from cutis import maps", 1),
        ("optics/a.py", "import cutis.transport.fresnel", 1),
        ("optics/a.py", "import cutis", 1),
        ("optics/a.py", "from ..maps import SkinMaps", 1),
        ("optics/a.py", "from .. import maps", 1),
        ("optics/__init__.py", "from ..maps import SkinMaps", 1),
        ("optics/a.py", "def f():\n    from cutis import maps", 1),
        ("textures/a.py", "from cutis.maps import SkinMaps", 1),
        ("errors.py", "from cutis import optics", 1),
        ("stray.py", "from cutis import optics", 1),
        # downward, sideways, shared, from the root
        ("maps/a.py", "from cutis.textures import write", 0),
        ("maps/a.py", "from cutis import optics, textures", 0),
        ("maps/a.py", "from . import presets\nfrom .b import c\nfrom ..optics import NAMES", 0),
        ("maps/__init__.py", "from .b import c", 0),
        ("maps/a.py", "from cutis.errors import CutisError", 0),
        ("__init__.py", "from cutis.apps import main", 0),
        # slow packages
        ("maps/a.py", "import torch", 1),
        ("maps/a.py", "import torch.nn as nn", 1),
        ("inverse/training.py", "import torch", 0),
        ("maps/a.py", "class A:\n    import colour", 1),
        ("maps/a.py", "if True:\n    from matplotlib import pyplot", 1),
        ("maps/a.py", "def f():\n    import torch, colour\n    import matplotlib.pyplot", 0),
        ("__init__.py", "import matplotlib", 1),
        ("maps/a.py", "from cutis.colour import to_rgb\nfrom ..colour import to_rgb", 0),
    ],
)
def test_the_rules_bite(tmp_path, file, source, count):
    path = tmp_path / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(source)
    assert len(violations(path, tmp_path)) == count
