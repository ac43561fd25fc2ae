import sys
from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.render import blender_install
from cutis.render.blender_install import install, own_folder, own_python


def test_the_folder_is_beside_the_virtual_environment_or_the_users_own(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "venv"))
    assert own_folder() == tmp_path / "venv" / "cutis-blender"
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)
    monkeypatch.delenv("LOCALAPPDATA", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    assert own_folder() == tmp_path / "data" / "cutis-blender"
    monkeypatch.delenv("XDG_DATA_HOME")
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    assert own_folder() == tmp_path / ".local" / "share" / "cutis-blender"


def test_an_environment_counts_once_it_is_finished(tmp_path):
    assert own_python(tmp_path) is None
    python = blender_install._python_of(tmp_path)
    python.parent.mkdir()
    python.touch()
    assert own_python(tmp_path) is None
    (tmp_path / blender_install._STAMP).touch()
    assert own_python(tmp_path) == python


def test_what_fails_leaves_nothing_and_says_why(tmp_path, monkeypatch):
    """pip cannot reach an index on a port where nothing listens."""
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")
    monkeypatch.setenv("PIP_RETRIES", "0")
    monkeypatch.setenv("PIP_NO_CACHE_DIR", "1")
    for name in ("PIP_FIND_LINKS", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(name, raising=False)
    steps = []
    with pytest.raises(CutisError, match=r"^Blender cannot be installed: .*bpy"):
        install(tmp_path / "env", steps.append, sys.executable)
    assert len(steps) == 2
    assert not (tmp_path / "env").exists()


def test_an_interrupt_leaves_nothing(tmp_path):
    def interrupt(step):
        if "Blender" in step:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        install(tmp_path / "env", interrupt, sys.executable)
    assert not (tmp_path / "env").exists()


def test_without_a_fitting_python_one_line_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(blender_install, "PYTHONS", ("3.1", "3.2"))
    with pytest.raises(CutisError, match=r"needs Python 3\.1 or 3\.2, and there is none on PATH"):
        install(tmp_path / "env")
    assert not (tmp_path / "env").exists()
