import os
import stat
import sys

import pytest

from cutis.errors import CutisError
from cutis.render import blender as module
from cutis.render.blender import find_blender, quiet_environment

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the programs made here are shell scripts")


@pytest.fixture(autouse=True)
def nothing_installed(monkeypatch, tmp_path):
    """No Blender of this machine is found."""
    monkeypatch.delenv("BLENDER", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setattr(module, "own_python", lambda: None)
    (tmp_path / "bin").mkdir()


def program(path, says="", status=0):
    """An executable that prints something and ends."""
    path.write_text(f"#!/bin/sh\necho '{says}'\nexit {status}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_without_any_the_line_says_how_to_install_one():
    with pytest.raises(CutisError, match=r"no Blender; .*`cutis render --install`.*--blender PATH"):
        find_blender()


def test_the_one_on_path_is_found(tmp_path):
    path = program(tmp_path / "bin" / "blender", "Blender 4.2.1 LTS")
    found = find_blender()
    assert (found.executable, found.version, found.module) == (path, (4, 2, 1), False)


def test_a_version_too_old_is_refused_in_one_line(tmp_path):
    path = program(tmp_path / "bin" / "blender", "Blender 3.4.1")
    with pytest.raises(CutisError) as error:
        find_blender()
    assert str(error.value) == (
        f"{path}: Blender 3.4.1 is too old, 4.2 is the first that works; "
        "`cutis render --install` installs one that does"
    )


def test_order_path_then_variable_then_own_then_search_path(tmp_path, monkeypatch):
    versions = {}
    for minor, name in ((2, "given"), (3, "variable"), (4, "own"), (5, "bin/blender")):
        versions[name] = program(tmp_path / name, f"Blender 4.{minor}.0")
    given, variable, own, _ = versions.values()
    assert find_blender().version == (4, 5, 0)
    monkeypatch.setattr(module, "own_python", lambda: own)
    assert find_blender().version == (4, 4, 0)
    monkeypatch.setenv("BLENDER", str(variable))
    assert find_blender().version == (4, 3, 0)
    assert find_blender(given).version == (4, 2, 0)


def test_a_folder_that_holds_one_will_do(tmp_path):
    (tmp_path / "blender-4.5").mkdir()
    path = program(tmp_path / "blender-4.5" / "blender", "Blender 4.5.0")
    assert find_blender(tmp_path / "blender-4.5").executable == path


def test_what_is_no_blender_is_refused(tmp_path, monkeypatch):
    with pytest.raises(CutisError, match="no such Blender"):
        find_blender(tmp_path / "nowhere")
    with pytest.raises(CutisError, match="no Blender in this folder"):
        find_blender(tmp_path)
    with pytest.raises(CutisError, match="is not a Blender"):
        find_blender(program(tmp_path / "other", "Gimp 3.0"))
    (tmp_path / "text").write_text("Blender 4.2.0")
    with pytest.raises(CutisError, match="cannot run"):
        find_blender(tmp_path / "text")
    monkeypatch.setenv("BLENDER", str(tmp_path / "nowhere"))
    with pytest.raises(CutisError, match=r"^\$BLENDER: "):
        find_blender()


def test_a_python_without_the_module_is_refused():
    with pytest.raises(CutisError, match="a Python without the module bpy"):
        find_blender(sys.executable)


def test_one_that_hangs_is_given_up(tmp_path, monkeypatch):
    path = tmp_path / "blender"
    path.write_text("#!/bin/sh\nexec /bin/sleep 60\n")
    path.chmod(0o755)
    monkeypatch.setattr(module, "_PATIENCE", 0.5)
    with pytest.raises(CutisError, match="does not answer"):
        find_blender(path)


def test_the_users_settings_stay_out(tmp_path, monkeypatch):
    monkeypatch.setenv("OCIO", "studio.ocio")
    monkeypatch.setenv("PYTHONPATH", "elsewhere")
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", "mine")
    given = quiet_environment(tmp_path)
    assert not {"OCIO", "PYTHONPATH", "BLENDER_USER_SCRIPTS"} & set(given)
    assert given["BLENDER_USER_RESOURCES"] == str(tmp_path)


def test_command_lines(tmp_path):
    blender = module.Blender(tmp_path / "blender", False, (4, 2, 0))
    line = blender.command(tmp_path / "scene.py", "job.json")
    assert line[0] == str(tmp_path / "blender")
    assert line[-2:] == ["--", "job.json"]
    assert {"--background", "--factory-startup"} < set(line)
    python = module.Blender(tmp_path / "python", True, (5, 0, 1))
    assert python.command(tmp_path / "scene.py", "job.json")[1:] == [
        *("-I", str(tmp_path / "scene.py"), "job.json")
    ]
