import json
from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.render.scene import Scene


def test_a_job_is_plain_json_with_absolute_paths(tmp_path, monkeypatch):
    for name in ("colour.exr", "head.obj", "normal.exr"):
        (tmp_path / name).touch()
    monkeypatch.chdir(tmp_path)
    scene = Scene(base_colour=Path("colour.exr"), mesh="head.obj", normal=Path("normal.exr"))
    job = json.loads(json.dumps(scene.job(Path("out.exr"))))
    for key, name in {
        **{"base_colour": "colour.exr", "mesh": "head.obj", "normal": "normal.exr"},
        "output": "out.exr",
    }.items():
        assert job[key] == str(tmp_path / name)
    assert job["radius"] == [1.0, 1.0, 1.0]
    assert job["roughness"] == 0.5
    assert job["millimetres_per_unit"] is None


@pytest.mark.parametrize(
    ("mesh", "light", "tilt", "told"),
    [
        ("patch", "studio", None, 15.0),
        ("patch", "furnace", None, 0.0),
        ("patch", "studio", 3.0, 3.0),
        ("sphere", "studio", None, 0.0),
    ],
)
def test_the_patch_leans_unless_told_otherwise(mesh, light, tilt, told):
    scene = Scene(mesh=mesh, light=light, tilt=tilt)
    assert scene.job(Path("out.exr"))["tilt"] == told


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"base_colour": (0.5, 1.5, 0.5)}, "base colour is 1.5"),
        ({"base_colour": (0.5, 0.5)}, "has 2 values"),
        ({"base_colour": Path("nowhere.exr")}, "nowhere.exr: there is no such file"),
        ({"radius": (1.0, -1.0, 1.0)}, "radius is -1"),
        ({"anisotropy": 1.0}, "anisotropy is 1"),
        ({"roughness": float("nan")}, "roughness is nan"),
        ({"normal": Path("nowhere.png")}, "normal map"),
        ({"mesh": "head.fbx"}, "not a mesh that can be read"),
        ({"mesh": "nowhere.obj"}, "nowhere.obj: there is no such file"),
        ({"millimetres_per_unit": 0.0}, "millimetres per mesh unit"),
        ({"subdivision": 9}, "subdivision is 9"),
        ({"light": "moon"}, "one of studio, sun, interior, furnace"),
        ({"method": "burley"}, "one of random_walk"),
        ({"device": "tpu"}, "one of auto, cpu, gpu"),
        ({"width": 0}, "width is 0"),
        ({"samples": 1.5}, "whole number"),
        ({"seed": -1}, "seed is -1"),
        ({"centre": (0.5, 2.0)}, "centre is 2"),
    ],
)
def test_what_cannot_be_is_refused_with_a_clear_line(wrong, says):
    with pytest.raises(CutisError, match=says):
        Scene(**wrong)
