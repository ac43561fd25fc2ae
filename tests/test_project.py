"""What holds for the project as a whole: what is tracked, documented, cited and imported."""

import ast
import dataclasses
import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Literal

import hypothesis
import pytest

from studies.import_graph import Graph, circle

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "cutis"
FORBIDDEN = [re.compile(line) for line in (ROOT / ".ci/forbidden").read_text("utf-8").splitlines()]
"""Paths of one machine and hosts of package registries, as extended regular expressions."""
CITATION = re.compile(r"\b[a-z]+(?:19|20)\d\d[a-z0-9]*\b")
"""A key of the bibliography inside brackets: [jacques2013], [donner2006, after sarna2006]."""


def project_files() -> list[Path]:
    """Files that are tracked, or would be by `git add .`."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git work tree")
    listing = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return sorted({ROOT / name for name in listing.split("\0") if name and (ROOT / name).is_file()})


def forbidden_lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if any(p.search(line) for p in FORBIDDEN)]


def rooms() -> list[str]:
    """Rooms that exist, by the folders of the package."""
    return sorted(p.parent.name for p in PACKAGE.glob("*/__init__.py") if p.parent.name != "data")


def is_documentable(item: object) -> bool:
    """Functions (compiled ones too), classes and modules; not constants and type aliases."""
    compiled = hasattr(item, "py_func")
    return compiled or inspect.isroutine(item) or inspect.isclass(item) or inspect.ismodule(item)


def lacks_docstring(item: object) -> bool:
    """Whether a public object has no docstring of its own (a dataclass's signature is none)."""
    text = (getattr(item, "__doc__", None) or "").strip()
    return not text or (inspect.isclass(item) and text.startswith(f"{item.__name__}("))


def cited(source: str) -> set[str]:
    """Bibliography keys in the strings of a module (docstrings are strings)."""
    strings = (
        node.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    brackets = (inside for text in strings for inside in re.findall(r"\[([^\[\]]+)\]", text))
    return {key for inside in brackets for key in CITATION.findall(inside)}


def header(csv: Path) -> str:
    """The comment lines before the first row of a table."""
    lines = csv.read_text("utf-8").splitlines()
    end = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    return "\n".join(lines[:end])


def test_no_file_names_a_machine_or_a_registry():
    found = []
    for path in project_files():
        content = path.read_bytes()
        if b"\0" not in content:
            lines = forbidden_lines(content.decode("utf-8"))
            found += [f"{path.relative_to(ROOT)}: {line[:120]}" for line in lines]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("line", "is_forbidden"),
    [
        ("see " + "/".join(["", "root", "notes.txt"]), True),
        ("file://" + "/".join(["", "home", "someone", "face.png"]), True),
        ("https://" + ".".join(["py" + "pi", "org"]) + "/simple", True),
        ("../shared/data", False),
        ("a frame/work/flow", False),
        ("docs/references.bib", False),
    ],
)
def test_forbidden_patterns_bite(line, is_forbidden):
    assert bool(forbidden_lines(line)) == is_forbidden


def test_constraints_are_exact_pins():
    lines = (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert "torch==2.13.0" in pins
    loose = [pin for pin in pins if not re.fullmatch(r"[A-Za-z0-9._-]+==[0-9][0-9a-z.]*", pin)]
    assert not loose


@pytest.mark.parametrize("room", rooms())
def test_public_names_have_docstrings(room):
    module = importlib.import_module(f"cutis.{room}")
    assert not lacks_docstring(module)
    names = getattr(module, "__all__", None)
    assert names is not None or room == "apps", f"cutis.{room} says nothing about what is public"
    items = {name: getattr(module, name) for name in names or ()}
    undocumented = [
        name for name, item in items.items() if is_documentable(item) and lacks_docstring(item)
    ]
    assert not undocumented


def test_a_missing_docstring_is_seen():
    @dataclasses.dataclass
    class Bare:
        value: float

    def bare():
        return None

    assert is_documentable(Bare)
    assert lacks_docstring(Bare)
    assert is_documentable(bare)
    assert lacks_docstring(bare)
    assert not lacks_docstring(lacks_docstring)
    assert not is_documentable(Literal["alias"])


@pytest.mark.parametrize("room", rooms())
def test_rooms_are_in_the_api_page(room):
    assert f"::: cutis.{room}\n" in (ROOT / "docs/api.md").read_text("utf-8") + "\n"


def test_citations_are_in_the_bibliography():
    keys = set(
        re.findall(r"^@\w+\{(\S+),$", (ROOT / "docs/references.bib").read_text("utf-8"), re.M)
    )
    used = {key for path in PACKAGE.rglob("*.py") for key in cited(path.read_text("utf-8"))}
    assert "aliaga2022" in used
    assert used - keys == set()


@pytest.mark.parametrize(
    "csv", sorted(PACKAGE.glob("data/**/*.csv")), ids=lambda p: p.relative_to(PACKAGE).as_posix()
)
def test_tables_name_source_and_unit(csv):
    comment = header(csv)
    assert re.search(r"\bsource:", comment, re.I), "no source"
    assert re.search(r"\bunits?:|\[[^\]]+\]", comment, re.I), "no unit: 'Unit: …' or 'name [nm]'"


def test_import_is_light():
    """What takes seconds to import waits until a function needs it."""
    names = "torch colour jinja2 matplotlib scipy.spatial numba"
    code = (
        "import sys, cutis\n"
        "assert cutis.__file__, 'a namespace, not the package'\n"
        f"print(*(name for name in {names.split()} if name in sys.modules))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert result.stdout.split() == []


def test_examples_stay_out_of_the_package(capture1):
    """They are in the repository, for the demo, and have their licence beside them."""
    for path in capture1:
        assert path.is_file()
    assert "MIT License" in (ROOT / "examples/BioSkin-MIT.txt").read_text("utf-8")
    assert not [p for p in PACKAGE.rglob("*") if "capture" in p.name]


def test_no_modules_import_each_other_round_about():
    """Not inside functions either."""
    assert " → ".join(circle(Graph(ROOT).imports)) == ""


def test_rooms_are_of_a_size():
    """The largest holds at most 15 % of the lines, the command line at most 10 %."""
    lines = {room: 0 for room in rooms()}
    for path in PACKAGE.rglob("*.py"):
        room = path.relative_to(PACKAGE).parts[0]
        if room in lines:
            lines[room] += len(path.read_text("utf-8").splitlines())
    shares = {room: count / sum(lines.values()) for room, count in lines.items()}
    assert {room: f"{share:.1%}" for room, share in shares.items() if share > 0.15} == {}
    assert shares["apps"] <= 0.10


UNSEEDED = {"default_rng", "Random", "SystemRandom", "RandomState", "token_hex", "uuid4"}
"""Makers of random numbers that are others in every run where nothing is given to them."""


def unseeded(source: str) -> list[int]:
    """Lines that draw random numbers which are others in every run."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
            whole = ast.unparse(node.func)
            global_one = re.fullmatch(r"np\.random\.(?!default_rng|Generator)\w+", whole)
            if (name in UNSEEDED and not node.args and not node.keywords) or global_one:
                found.append(node.lineno)
            if re.fullmatch(r"random\.(random|randint|choice|shuffle|uniform|sample)", whole) and (
                "import random\n" in source
            ):
                found.append(node.lineno)
    return found


def test_tests_draw_the_same_numbers_every_time():
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for folder in ("tests", "studies", "benchmarks")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for line in unseeded(path.read_text("utf-8"))
    ]
    assert found == []
    if "CUTIS_PROPERTIES" not in os.environ:
        assert hypothesis.settings.default.derandomize


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("np.random.default_rng(0)", 0),
        ("np.random.default_rng()", 1),
        ("default_rng()", 1),
        ("np.random.rand(3)", 1),
        ("Random(seed)", 0),
        ("Random()", 1),
        ("import random\nrandom.choice([1, 2])", 1),
        ("random = draw(randoms)\nrandom.choice([1, 2])", 0),
        ("uuid.uuid4()", 1),
    ],
)
def test_numbers_without_a_seed_are_seen(source, count):
    assert len(unseeded(source)) == count
