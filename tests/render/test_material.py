"""Materials as values, and their description."""

import json

import pytest

from cutis.errors import CutisError
from cutis.render.material import Gloss, Material, write_description


def skin(**changes):
    given = {
        "name": "face",
        "albedo": "face.albedo.exr",
        "single_scattering": "face.single_scattering.exr",
        "radius": (0.08, 0.06, 0.05),
        "anisotropy": 0.78,
        "millimetres": 48.0,
        **changes,
    }
    return Material(**given)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radius": (0.0, 1.0, 1.0)}, "must be positive"),
        ({"radius": (float("nan"), 1.0, 1.0)}, "must be positive"),
        ({"millimetres": 0.0}, "must be positive"),
        ({"millimetres": float("inf")}, "must be positive"),
        ({"anisotropy": 1.0}, "between -1 and 1"),
    ],
)
def test_what_cannot_be_is_refused(changes, message):
    with pytest.raises(CutisError, match=message):
        skin(**changes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"roughness": (0.3, 1.2)}, "roughness must lie in 0 to 1"),
        ({"mix": -0.1}, "mix of two lobes"),
        ({"strength": 1.5}, "strength"),
        ({"refractive_index": 0.9}, "not that of skin"),
    ],
)
def test_gloss_that_cannot_be_is_refused(arguments, message):
    with pytest.raises(CutisError, match=message):
        Gloss(**arguments)


def test_stronger_lobe_comes_first():
    assert Gloss((0.3, 0.6), 0.85).lobes == ((0.3, 0.85), (0.6, pytest.approx(0.15)))
    assert Gloss((0.3, 0.6), 0.2).lobes == ((0.6, 0.8), (0.3, 0.2))
    assert Gloss((0.3, 0.6), 0.5).lobes == ((0.6, 0.5), (0.3, 0.5))


def test_description_has_every_number_with_its_unit(tmp_path):
    path = tmp_path / "face.material.json"
    material = skin(
        radius_texture="face.radius.exr", notes={"edits": ["melanin x2"]}, credits=("née Å",)
    )
    write_description(material, path)
    stored = json.loads(path.read_text("utf-8"))
    assert stored["radius_mm"] == [0.08, 0.06, 0.05]
    assert stored["anisotropy"] == 0.78
    assert stored["millimetres_per_unit"] * stored["scene_units_per_millimetre"] == 1
    assert stored["specular"]["refractive_index"] == 1.4
    assert {k: (v["file"], v["unit"]) for k, v in stored["textures"].items()} == {
        "albedo": ("face.albedo.exr", "1"),
        "single_scattering": ("face.single_scattering.exr", "1"),
        "radius": ("face.radius.exr", "mm"),
    }
    assert stored["edits"] == ["melanin x2"]
    assert stored["credits"] == ["née Å"]
    assert "radius" not in skin().description()["textures"]
