"""Records of what generated files are made of, and what they say when something has changed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from studies import generated
from studies.generated import MAKERS, expected

ROOT = Path(__file__).parents[2]
TOOL = """
from pathlib import Path
from studies.generated import record
from studies.pages import rewrite
from cutis.optics.tissue import WATER
from cutis.maps.look import look

ROOT = Path(__file__).parents[1]

def main():
    rows = (ROOT / "src/cutis/data/skin.csv").read_text()
    (ROOT / "docs/plot.png").write_text(look(rows))
    record(ROOT / "docs/plot.png")
    rewrite("page.md", numbers=rows)

if __name__ == "__main__":
    main()
"""


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A small project with a tool that has run."""
    files = {
        "src/cutis/__init__.py": "", "src/cutis/optics/__init__.py": "",
        "src/cutis/maps/__init__.py": "",
        "src/cutis/optics/tissue.py": '"""Words."""\nWATER = 0.7\n',
        "src/cutis/maps/look.py": "def look(text):\n    return text.upper()\n",
        "src/cutis/data/skin.csv": "melanin,0.02\n",
        "docs/page.md": "<!-- numbers -->\n<!-- /numbers -->\n",
        "studies/tool.py": TOOL,
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    for name in ("__init__.py", "generated.py", "pages.py"):
        shutil.copy(ROOT / "studies" / name, tmp_path / "studies" / name)
    makers = 'MAKERS = {"studies.tool": ["docs/plot.png", "docs/page.md#*"]}\nOLD = {'
    source = (tmp_path / "studies/generated.py").read_text()
    (tmp_path / "studies/generated.py").write_text(source.replace("MAKERS = {", makers, 1))
    return tmp_path


def call(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True,
        env={"PYTHONPATH": f"{folder}/src:{folder}", "PATH": ""},
    )  # fmt: skip


def test_a_tool_notes_what_it_used(clone):
    assert call(clone, "studies.tool").returncode == 0
    found = json.loads((clone / "docs/generated.json").read_text())
    assert set(found["files"]) == {"docs/plot.png", "docs/page.md#numbers"}
    made = found["made"]["studies.tool"]
    assert made["command"] == "python -m studies.tool"
    assert set(made["data"]) == {
        "src/cutis/data/skin.csv", "src/cutis/optics/__init__.py", "src/cutis/optics/tissue.py",
        "studies/tool.py",
    }  # fmt: skip
    assert set(made["rooms"]) == {"maps", "optics"}
    assert str(clone) not in (clone / "docs/generated.json").read_text()
    ended = call(clone, "studies.generated")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "2 generated files and tables" in ended.stdout


@pytest.mark.parametrize(
    ("name", "old", "new", "code", "says"),
    [
        ("src/cutis/data/skin.csv", "0.02", "0.03", 1, "changed since: src/cutis/data/skin.csv"),
        ("src/cutis/optics/tissue.py", "0.7", "0.8", 1, "src/cutis/optics/tissue.py"),
        ("studies/tool.py", "numbers=rows", "numbers=rows * 2", 1, "studies/tool.py"),
        ("docs/plot.png", "MELANIN", "melanin", 1, "docs/plot.png: changed since by another hand"),
        ("docs/page.md", "0.02", "0.3", 1, "docs/page.md#numbers: changed since by another"),
        ("docs/generated.json", '"docs/plot.png"', '"docs/p.png"', 1, "nobody noted"),
        ("src/cutis/maps/look.py", "upper", "lower", 0, "of the same data by older code"),
        ("src/cutis/optics/tissue.py", "Words.", "Other words.", 0, "2 generated files"),
        ("docs/page.md", "<!-- /numbers -->", "<!-- /numbers -->\nMore words.", 0, "2 generated"),
    ],
)
def test_what_has_changed_is_named(name, old, new, code, says, clone):
    assert call(clone, "studies.tool").returncode == 0
    text = (clone / name).read_text()
    assert old in text
    (clone / name).write_text(text.replace(old, new))
    ended = call(clone, "studies.generated")
    assert ended.returncode == code, ended.stdout + ended.stderr
    assert says in ended.stdout
    if code:
        assert call(clone, "studies.generated", "--remake").returncode == 0
        assert "2 generated files" in call(clone, "studies.generated").stdout


def test_every_generated_file_has_one_maker():
    """Tables between markers, pictures of the docs, and shipped data that tools write."""
    found = expected()
    tables = {
        f"{page.relative_to(ROOT).as_posix()}#{name}"
        for page in (ROOT / "docs").rglob("*.md")
        for name in generated.TABLE.findall(page.read_text("utf-8"))
    }
    pictures = {
        path.relative_to(ROOT).as_posix()
        for folder in ("images", "renders", "reproduction")
        for path in (ROOT / "docs" / folder).iterdir()
    }
    assert tables | pictures <= set(found)
    for module in MAKERS:
        assert (ROOT / f"{module.replace('.', '/')}.py").is_file() or (
            ROOT / module.replace(".", "/") / "__main__.py"
        ).is_file()
        assert module in found.values(), f"{module} makes nothing"
        assert module.removeprefix("studies.") in (ROOT / "studies/README.md").read_text("utf-8")


def test_records_are_of_files_that_exist():
    known, records = expected(), generated.load()
    assert set(records["files"]) <= set(known)
    for key, note in records["files"].items():
        assert note["by"] == known[key]
        assert note["by"] in records["made"]
