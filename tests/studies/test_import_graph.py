"""What a change reaches, on a small project, and the quick run that is made of it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from studies.import_graph import Graph, circle

ROOT = Path(__file__).parents[2]
FILES = {
    "src/cutis/__init__.py": "",
    "src/cutis/optics/__init__.py": "from cutis.optics.tissue import Tissue\n"
    "from cutis.optics.names import NAMES\n__all__ = ['NAMES', 'Tissue']\n",
    "src/cutis/optics/tissue.py": "class Tissue: ...\n",
    "src/cutis/optics/names.py": "NAMES = ('melanin',)\n",
    "src/cutis/maps/__init__.py": "",
    "src/cutis/maps/edits.py": "def f():\n    from ..optics import Tissue\n    return Tissue\n",
    "src/cutis/maps/look.py": "TABLE = 'looks.csv'\nFOLDER = ('data', 'page')\n",
    "tests/conftest.py": "import pytest\n@pytest.fixture\ndef skin():\n"
    "    from cutis.maps import edits\n    return edits.f()\n",
    "tests/optics/test_names.py": "from cutis.optics import NAMES\ndef test_it(): assert NAMES\n",
    "tests/optics/test_tissue.py": "import cutis.optics.tissue\ndef test_it(): assert cutis\n",
    "tests/maps/test_skin.py": "def test_skin(skin): assert skin\n",
    "tests/maps/test_process.py": "CODE = 'import cutis.maps.edits'\ndef test_it(): assert CODE\n",
    "tests/maps/test_look.py": "from cutis.maps.look import TABLE\ndef test_it(): assert TABLE\n",
}  # fmt: skip


@pytest.fixture
def project(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("changed", "reached"),
    [
        ("src/cutis/optics/names.py", {"tests/optics/test_names.py": 1}),
        (
            "src/cutis/optics/tissue.py",
            {"tests/optics/test_tissue.py": 1, "tests/maps/test_skin.py": 2,
             "tests/maps/test_process.py": 2},
        ),
        ("src/cutis/data/page/page.html", {"tests/maps/test_look.py": 1}),
        ("examples/looks.csv", {"tests/maps/test_look.py": 1}),
        ("tests/maps/test_skin.py", {"tests/maps/test_skin.py": 0}),
        ("README.md", {}),
    ],
)  # fmt: skip
def test_what_a_change_reaches(changed, reached, project):
    found = Graph(project).reached([Path(changed)])
    tests = {p.as_posix(): n for p, n in found.items() if p.parts[0] == "tests"}
    assert tests == reached


def test_circles_are_found_inside_functions_too(project):
    assert circle(Graph(project).imports) == []
    names = project / "src/cutis/optics/names.py"
    names.write_text("def f():\n    from cutis.maps.edits import f\n")
    tissue = project / "src/cutis/optics/tissue.py"
    tissue.write_text("from cutis.optics import NAMES\nclass Tissue: ...\n")
    found = circle(Graph(project).imports)
    assert set(found) == {"cutis.optics.names", "cutis.optics.tissue", "cutis.maps.edits"}
    assert found[0] == found[-1]


def test_a_quick_run(project):
    for name in ("studies/import_graph.py", "tests/quick.py"):
        (project / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, project / name)
    (project / "pyproject.toml").write_text(
        "[tool.pytest.ini_options]\npythonpath = ['.', 'src']\n"
        "addopts = ['--import-mode=importlib', '-ptests.quick']\n"
    )
    for command in ("init -qb main", "add .", "-c user.name=a -c user.email=a@b.c commit -qm a"):
        subprocess.run(["git", *command.split()], cwd=project, check=True)

    def run(*flags):
        environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
        environment |= {"PYTHONPATH": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-v", "-pxdist", "-n2", "--quick", *flags],
            cwd=project, capture_output=True, text=True, env=environment,
        )  # fmt: skip
        return done.stdout

    (project / "src/cutis/optics/tissue.py").write_text("class Tissue: later = 1\n")
    (project / "tests/optics/test_new.py").write_text("def test_new(): assert 0\n")
    said = run("60")
    assert "1 failed, 3 passed" in said
    assert "test_names" not in said
    times = project / ".pytest_cache/v/cutis/seconds"
    times.write_text(times.read_text().replace('test_new": 0.', 'test_new": 9.'))
    assert "4 tests in reach did not fit; they are in tests/maps/test_process.py" in run("1")
