"""What the files are made of that tools write: docs/generated.json, and which of them are stale.

    python -m studies.generated            # names stale files; ends in 1 if there are any
    python -m studies.generated --remake   # runs their commands again first

Each tool calls `record` for what it wrote, a file or a table of a page. The record holds the
command, and digests of what the tool used: files that it read from the package's data, from
examples/ and from the larger data, its own sources, and the rooms of the package that it ran.
Digests of sources leave out comments and docstrings. A file is *stale* if its data, its own tool,
or the constants of `optics` are others now; if only other code of the package is, it is named too,
as made by older code, but no fault: tests hold results where code is rewritten.
"""

import ast
import hashlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from studies import READ

ROOT = Path(__file__).parents[1]
SHARED = Path(os.environ.get("CUTIS_SHARED_DATA") or ROOT.parent / "shared" / "data").resolve()
DATA = ("src/cutis/data", "examples", "studies/figures/words")
"""Folders whose files count as data."""
CONSTANTS = "src/cutis/optics"
"""Sources that hold the constants of skin, and count as data."""
OURS = {
    "src/cutis/data/__init__.py", "studies/__init__.py", "studies/generated.py", "studies/pages.py",
}  # fmt: skip
"""Files that decide nothing of what is written."""
MANIFEST = ROOT / "docs" / "generated.json"
MAKERS = {
    "studies.build_colour_tables": ["src/cutis/data/colour/*.csv"],
    "studies.build_albedo_table": ["src/cutis/data/albedo/*.npz"],
    "studies.train_prior": ["src/cutis/data/weights/*-prior.npz"],
    "studies.build_weights": [
        "src/cutis/data/weights/measured2026.npz",
        "src/cutis/data/weights/measured2026b.npz",
        "src/cutis/data/weights/measured2026b-trust.npz",
        "src/cutis/data/weights/measured2026-trust.npz",
        "src/cutis/data/weights/aliaga2022-exact.npz",
    ],
    "studies.look_schema": ["docs/look.schema.json"],
    "studies.build_tones": [
        "src/cutis/data/tones/*.csv", "docs/tones.md#path", "docs/tones.md#halves",
    ],
    "studies.tone_accuracy": ["docs/tones.md#tones*", "docs/images/tones.jpg"],
    "studies.preset_sheet": ["docs/presets.md#presets", "docs/images/presets.jpg"],
    "studies.build_appearance": ["src/cutis/data/page/*.csv", "src/cutis/data/page/*.ttf"],
    "studies.albedo_accuracy": ["docs/albedo.md#*"],
    "studies.albedo_inversion": ["docs/subsurface.md#*", "docs/images/subsurface.png"],
    "studies.baked_accuracy": ["docs/models.md#baked*"],
    "studies.engine_check": ["docs/engines.md#*"],
    "studies.figures": ["docs/reproduction.md", "docs/reproduction/*.jpg"],
    "studies.gitlina_comparison": ["docs/models.md#gitlina*"],
    "studies.illuminant_accuracy": ["docs/colour.md#*"],
    "studies.kubelka_munk_accuracy": ["docs/models.md#kubelka*"],
    "studies.light_alternatives": ["docs/decisions/0009-illuminants.md#*"],
    "studies.check_faults": ["docs/checks.md#*"],
    "studies.lut_accuracy": ["docs/lut.md#*"],
    "studies.model_accuracy": [
        "docs/models.md#recovery", "docs/models.md#smooth", "docs/models.md#loop",
    ],
    "studies.monte_carlo_accuracy": ["docs/transport.md#walks"],
    "studies.readme_picture": ["docs/images/face.jpg"],
    "studies.render_grid": ["docs/renders/*.jpg", "docs/render.md#*"],
    "studies.steady_picture": ["docs/images/steady.jpg"],
    "studies.steady_accuracy": ["docs/models.md#steady_*"],
    "studies.transport_convergence": [
        "docs/transport.md#convergence", "docs/transport.md#published",
        "docs/transport.md#kubelka",
    ],
    "studies.validation": ["docs/validation.md#*", "docs/images/validation-*.png"],
}  # fmt: skip
"""Who makes what, in an order in which it can be made again: modules, and patterns of files, or of
tables as PAGE#TABLE."""
ARGUMENTS = {"studies.figures": "-o docs"}
"""What a maker is to be called with, where it needs anything."""
TABLE = re.compile(r"<!-- ([\w-]+) -->")


def record(*names: str | Path) -> None:
    """Notes what the running tool wrote: files below the root, or "docs/page.md#table"."""
    found, (tool, called) = load(), command()
    found["made"][tool] = {"command": called, "data": used(), "rooms": rooms()}
    for name in names:
        key = str(name.relative_to(ROOT) if isinstance(name, Path) else name)
        found["files"][key] = {"by": tool, "digest": digest_of(key)}
    text = json.dumps(found, indent=1, sort_keys=True)
    MANIFEST.write_text(text + "\n", encoding="utf-8")


def load() -> dict[str, Any]:
    """`files`, by name, with digest and tool, and `made`, by tool, with what it used."""
    if MANIFEST.is_file():
        return dict(json.loads(MANIFEST.read_text("utf-8")))
    return {"files": {}, "made": {}}


def command() -> tuple[str, str]:
    """The running tool, and how it was called."""
    spec = getattr(sys.modules["__main__"], "__spec__", None)
    name = (spec.name if spec else Path(sys.argv[0]).stem).removesuffix(".__main__")
    arguments = (a for a in sys.argv[1:] if not Path(a).is_absolute())
    return name, " ".join(["python -m", name, *arguments])


def used() -> dict[str, str]:
    """Digests of the data, the constants and the sources of the tool that this process used."""
    loaded = [getattr(module, "__file__", None) for module in list(sys.modules.values())]
    sources = {key_of(Path(file)) for file in loaded if file}
    keys = {key for key in map(key_of, map(Path, READ)) if key and not key.endswith(".py")}
    keys |= {key for key in sources if key and key.startswith((CONSTANTS, "studies/"))}
    return {key: digest_of(key) for key in sorted(keys)}


def rooms() -> dict[str, str]:
    """Digests of the rooms of the package that are loaded."""
    found = {name.split(".")[1] for name in sys.modules if name.startswith("cutis.")} - {"data"}
    return {room: digest for room in sorted(found) if (digest := digest_of_room(room))}


@cache
def digest_of_room(room: str) -> str:
    """A digest of all sources of a room; "" where there is none."""
    paths = sorted((ROOT / "src" / "cutis" / room).glob("*.py"))
    joined = "".join(digest_of(path.relative_to(ROOT).as_posix()) for path in paths)
    return hashlib.sha256(joined.encode()).hexdigest()[:16] if paths else ""


def key_of(path: Path) -> str | None:
    """The name of a file that counts, below the root or in the larger data; else None."""
    path = Path(os.path.abspath(path))
    if path.is_relative_to(SHARED):
        return f"shared:{path.relative_to(SHARED).as_posix()}"
    if path.is_relative_to(ROOT) and path.is_file():
        key = path.relative_to(ROOT).as_posix()
        if "__pycache__" in key or key in OURS:
            return None
        if key.startswith(DATA) or (key.endswith(".py") and key.startswith(("src/", "studies/"))):
            return key
    return None


def digest_of(key: str) -> str:
    """A digest of a file, a source without comments and docstrings, or a table; "" if none."""
    name, _, table = key.partition("#")
    path = SHARED / name[7:] if name.startswith("shared:") else ROOT / name
    if not path.is_file():
        return ""
    content = path.read_bytes()
    if table:
        text = content.decode("utf-8")
        start, end = f"<!-- {table} -->", f"<!-- /{table} -->"
        if start not in text:
            return ""
        content = text.partition(start)[2].partition(end)[0].encode()
    elif name.endswith(".py"):
        content = _code(content).encode()
    return hashlib.sha256(content).hexdigest()[:16]


def expected(root: Path = ROOT) -> dict[str, str]:
    """Every file and table of MAKERS that is there, with the module that makes it."""
    found: dict[str, str] = {}
    for module, patterns in MAKERS.items():
        for pattern in patterns:
            name, _, table = pattern.partition("#")
            for path in sorted(root.glob(name)):
                key = path.relative_to(root).as_posix()
                if not table:
                    found[key] = module
                    continue
                wanted = re.compile(re.escape(table).replace(r"\*", ".*"))
                for name_ in TABLE.findall(path.read_text("utf-8")):
                    if wanted.fullmatch(name_):
                        found[f"{key}#{name_}"] = module
    return found


def stale() -> Iterator[tuple[str, str, str]]:
    """(name, module, why) of what is not as its maker would make it; "" for older code only."""
    records = load()
    for key, module in expected().items():
        note = records["files"].get(key)
        if note is None:
            yield key, module, "nobody noted what it was made of"
            continue
        made = records["made"][note["by"]]
        others = [name for name, old in made["data"].items() if _differs(name, old)]
        if note["digest"] != digest_of(key):
            yield key, module, "changed since by another hand"
        elif others:
            more = f" and {len(others) - 3} more" if len(others) > 3 else ""
            yield key, module, f"changed since: {', '.join(others[:3])}{more}"
        elif any(digest_of_room(room) != old for room, old in made["rooms"].items()):
            yield key, module, ""


def _differs(name: str, old: str) -> bool:
    """Whether a file is another one now; the larger data may not be at hand."""
    now = digest_of(name)
    return now != old and not (name.startswith("shared:") and not now)


def _code(content: bytes) -> str:
    tree = ast.parse(content)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [  # type: ignore[attr-defined]
                part for part in body
                if not (isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant))
            ]  # fmt: skip
    return ast.dump(tree)


def main() -> None:
    if "--remake" in sys.argv:
        for module in MAKERS:
            if any(maker == module and why for _, maker, why in stale()):
                call = ["-m", module, *ARGUMENTS.get(module, "").split()]
                print(" ".join(["python", *call]), flush=True)
                subprocess.run([sys.executable, *call], cwd=ROOT, check=True)
    found = list(stale())
    for key, module, why in found:
        if why:
            print(f"{key}: {why} (python -m {module})")
    older = sorted({module for _, module, why in found if not why})
    if older:
        print(f"of the same data by older code: what {', '.join(older)} write")
    if any(why for *_, why in found):
        sys.exit("to make them again, which takes an hour: python -m studies.generated --remake")
    print(f"{len(expected())} generated files and tables are of the data that is here")


if __name__ == "__main__":
    main()
