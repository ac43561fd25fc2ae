"""`python -m studies.figures`."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def figures(*flags):
    return subprocess.run(
        [sys.executable, "-m", "studies.figures", *map(str, flags)],
        cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip


def test_some_figures(tmp_path):
    ended = figures("--only", "palettes", "--only", "reflectance-series", "-o", tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert f"wrote {tmp_path / 'reproduction.md'}" in ended.stdout
    text = (tmp_path / "reproduction.md").read_text("utf-8")
    assert "## Palettes of the albedo space" in text
    assert "## Metamers" not in text
    assert (tmp_path / "reproduction" / "palettes-1.jpg").is_file()


@pytest.mark.parametrize(
    ("flags", "what"),
    [(("--only", "fig3"), "unknown figure 'fig3'"), (("--data", "nowhere"), "no folder albedo")],
)
def test_bad_flags_are_one_line(flags, what, tmp_path):
    ended = figures(*flags, "-o", tmp_path / "out")
    assert ended.returncode == 1
    assert what in ended.stderr
    assert ended.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
