"""Configurations that name files: which are read, and which are nobody's business."""

import os
import zipfile

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.textures import ocio, ocio_files
from cutis.textures.ocio import ocio_space

CONFIG = """ocio_profile_version: 2
search_path: "{search}"
roles: {{aces_interchange: reference, default: reference}}
file_rules:
  - !<Rule> {{name: Default, colorspace: default}}
displays:
  screen:
    - !<View> {{name: Raw, colorspace: reference}}
colorspaces:
  - !<ColorSpace> {{name: reference}}
  - !<ColorSpace>
    name: cam
    to_scene_reference: !<FileTransform> {{src: "{source}"}}
  - !<ColorSpace>
    name: grouped
    to_scene_reference: !<GroupTransform>
      children:
        - !<ColorSpaceTransform> {{src: cam, dst: reference}}
  - !<ColorSpace>
    name: plain
    to_scene_reference: !<ExponentTransform> {{value: [2.2, 2.2, 2.2, 1]}}
"""
CUBE = "LUT_1D_SIZE 2\n0 0 0\n0.5 0.5 0.5\n"
CTF = '<ProcessList version="2.0" id="1"><Reference path="{}" inBitDepth="32f" outBitDepth="32f"/></ProcessList>'  # noqa: E501


@pytest.fixture(autouse=True)
def fresh():
    for cache in (ocio_space, ocio._config):
        cache.cache_clear()


def config(folder, source, search=""):
    path = folder / "show.ocio"
    path.write_text(CONFIG.format(source=source, search=search), encoding="utf-8")
    return str(path)


def refused(name, path):
    with pytest.raises(CutisError) as caught:
        ocio_space(name, path)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert path in message
    return message


@pytest.mark.parametrize(
    ("source", "search"), [("a.cube", ""), ("luts/a.cube", ""), ("a.cube", "luts")]
)
def test_tables_of_the_show_are_read(tmp_path, source, search):
    (tmp_path / "luts").mkdir()
    where = tmp_path / search / source
    where.write_text(CUBE)
    space = ocio_space("cam", config(tmp_path, source, search))
    np.testing.assert_allclose(space.to_linear_srgb([[1, 1, 1]]), 0.5, rtol=1e-3)


def test_a_search_path_elsewhere_is_the_configurations_own_word(tmp_path):
    (tmp_path / "show").mkdir()
    (tmp_path / "library").mkdir()
    (tmp_path / "library" / "a.cube").write_text(CUBE)
    for search in (str(tmp_path / "library"), "../library"):
        ocio._config.cache_clear()
        ocio_space.cache_clear()
        assert ocio_space("cam", config(tmp_path / "show", "a.cube", search)) is not None


@pytest.mark.parametrize("name", ["cam", "grouped"])
def test_devices_and_pipes_are_never_opened(tmp_path, name):
    (tmp_path / "zero.cube").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe.cube")
    for source, what in [("zero.cube", "is a device"), ("pipe.cube", "is a pipe")]:
        ocio._config.cache_clear()
        ocio_space.cache_clear()
        message = refused(name, config(tmp_path, source))
        assert f"names a look-up table that cannot be used: {tmp_path / source}: {what}" in message


def test_files_outside_are_not_read(tmp_path):
    inside = tmp_path / "show"
    inside.mkdir()
    (tmp_path / "secret.cube").write_text(CUBE)
    for source in ("../secret.cube", str(tmp_path / "secret.cube"), "/dev/zero"):
        ocio._config.cache_clear()
        ocio_space.cache_clear()
        message = refused("cam", config(inside, source))
        assert f"names {source}, which is outside its folder and search path" in message


def test_spaces_that_do_not_need_it_work(tmp_path):
    path = config(tmp_path, "/dev/zero")
    assert ocio_space("plain", path).encoded
    assert ocio_space("reference", path) is not None


def test_tables_that_name_tables(tmp_path):
    (tmp_path / "a.ctf").write_text(CTF.format("/dev/zero"))
    assert "names /dev/zero, which is outside" in refused("cam", config(tmp_path, "a.ctf"))
    ocio._config.cache_clear()
    ocio_space.cache_clear()
    (tmp_path / "a.ctf").write_text(CTF.format("a.ctf"))
    assert "names others without end" in refused("cam", config(tmp_path, "a.ctf"))


def test_sizes_are_bounded(tmp_path, monkeypatch):
    (tmp_path / "a.cube").write_text(CUBE)
    monkeypatch.setattr(ocio_files, "LONGEST_LOOKUP", 10)
    assert "longer than" in refused("cam", config(tmp_path, "a.cube"))
    monkeypatch.setattr(ocio_files, "LONGEST_CONFIG", 10)
    ocio._config.cache_clear()
    ocio_space.cache_clear()
    assert "not a usable OpenColorIO configuration (is longer" in refused(
        "cam", config(tmp_path, "a.cube")
    )


def test_archives_are_weighed_before_they_are_unpacked(tmp_path, monkeypatch):
    path = tmp_path / "show.ocioz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as held:
        held.writestr("config.ocio", CONFIG.format(source="a.cube", search=""))
        held.writestr("a.cube", CUBE + " " * 100_000)
    assert ocio_space("plain", str(path)) is not None
    monkeypatch.setattr(ocio_files, "LONGEST_ARCHIVE", 50_000)
    ocio._config.cache_clear()
    ocio_space.cache_clear()
    assert "holds more than a configuration does" in refused("plain", str(path))


def test_a_configuration_that_is_no_file(tmp_path):
    (tmp_path / "z.ocio").symlink_to("/dev/zero")
    assert "(is a device, not a file; give a file)" in refused("cam", str(tmp_path / "z.ocio"))
