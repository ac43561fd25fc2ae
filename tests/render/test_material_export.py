"""All files of a material, and that they name each other."""

import json
import xml.etree.ElementTree as ElementTree

import pytest

from cutis.errors import CutisError
from cutis.maps import DEFAULT, Edit, estimate, save_maps
from cutis.maps.changes import Step
from cutis.render.blender import find_blender
from cutis.render.heads import head
from cutis.render.material_export import export_material
from cutis.render.skin import Skin
from cutis.textures import read_texture

SETTINGS = {"radius": (0.08, 0.06, 0.05), "anisotropy": 0.78, "millimetres": 48.0}


@pytest.fixture
def maps(tmp_path, write_face, face_mask):
    path = write_face(tmp_path)
    save_maps(estimate(read_texture(path), face_mask), tmp_path / "face.skin.exr")
    return tmp_path / "face.skin.exr"


def test_files_are_those_told_and_name_each_other(maps, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    changes = [Step((Edit("blood", "multiply", 2.0),), 0.5)]
    with Skin(maps) as skin:
        done = export_material(skin, folder, "tan", changes=changes, **SETTINGS)
    assert sorted(done.files) == sorted(folder.iterdir())
    stored = json.loads((folder / "tan.material.json").read_text("utf-8"))
    named = {texture["file"] for texture in stored["textures"].values()}
    assert named <= {path.name for path in done.files}
    assert stored["edits"] == ["blood x2, amount 0.5"]
    assert stored["model"] == DEFAULT
    assert stored["source"] == "face.skin.exr"
    assert stored["radius_mm"] == [0.08, 0.06, 0.05]
    root = ElementTree.parse(folder / "tan.mtlx").getroot()
    files = {i.get("value") for i in root.iter("input") if i.get("type") == "filename"}
    assert files == {"tan.albedo.exr"}


def test_credit_of_a_bundled_head_is_kept(tmp_path):
    scan = head("leeperrysmith")
    with Skin(scan.albedo) as skin:
        done = export_material(skin, tmp_path, "scan", **SETTINGS)
    assert done.material.credits == (scan.credit,)
    assert "Lee Perry-Smith" in (tmp_path / "scan.mtlx").read_text("utf-8")
    assert "Lee Perry-Smith" in (tmp_path / "scan.material.json").read_text("utf-8")


def test_credit_is_kept_where_maps_name_their_capture(tmp_path):
    """Also when the picture is of the maps alone."""
    scan = head("leeperrysmith")
    texture = read_texture(scan.albedo).rows(slice(500, 510))
    save_maps(estimate(texture), tmp_path / "scan.skin.exr")
    with Skin(tmp_path / "scan.skin.exr", model_only=True) as skin:
        done = export_material(skin, tmp_path, "scan", **SETTINGS)
    assert done.material.credits == (scan.credit,)


def test_folder_that_is_not_there_is_one_clear_line(maps, tmp_path):
    with Skin(maps) as skin, pytest.raises(CutisError, match="does not exist; create it first"):
        export_material(skin, tmp_path / "none", "tan", **SETTINGS)


def test_maps_of_normals_and_roughness_go_with_it(maps, tmp_path, write_face):
    given = write_face(tmp_path, "png8", name="bumps")
    folder = tmp_path / "out"
    folder.mkdir()
    with Skin(maps) as skin:
        done = export_material(skin, folder, "tan", normal=given, roughness=given, **SETTINGS)
    for kind in ("normal", "roughness"):
        assert (folder / f"tan.{kind}.png").read_bytes() == given.read_bytes()
        assert folder / f"tan.{kind}.png" in done.files
    with Skin(maps) as skin, pytest.raises(CutisError, match=r"none\.png: there is no such file"):
        export_material(skin, folder, "tan", normal=tmp_path / "none.png", **SETTINGS)


@pytest.mark.slow
def test_blender_file_is_among_them(maps, tmp_path):
    try:
        blender = find_blender()
    except CutisError as error:
        pytest.skip(str(error))
    folder = tmp_path / "out"
    folder.mkdir()
    with Skin(maps) as skin:
        done = export_material(skin, folder, "tan", blender=blender, **SETTINGS)
    assert sorted(done.files) == sorted(folder.iterdir())
    assert done.files[-1] == folder / "tan.blend"
    assert done.files[-1].stat().st_size > 10_000
    assert folder / "tan.cycles_colour.exr" in done.files
