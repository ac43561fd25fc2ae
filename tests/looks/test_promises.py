"""Presets do what their names promise, on a light, a brown and a dark face."""

import pytest

from cutis.looks import presets
from studies.preset_sheet import difference, expected
from studies.tone_faces import THREE, tried

ANY = (-99.0, 99.0)
LIGHT, BROWN, DARK = ((0,), (1,), (2,))
EVERY = (0, 1, 2)
# preset: faces, and ends of ΔL*, Δa*, Δb*
PROMISES = [
    ("tan-light", LIGHT, (-3.4, -1.4), ANY, ANY),
    ("tan", LIGHT, (-6.0, -3.0), ANY, ANY),
    ("tan-deep", LIGHT, (-11.0, -7.0), ANY, ANY),
    ("tan", EVERY, (-12.0, -3.0), ANY, ANY),
    ("ageing", LIGHT, (-4.4, -2.4), (-1.0, 1.0), (-1.0, 1.0)),
    ("ageing", EVERY, (-8.0, -2.4), ANY, ANY),
    ("sunburn", (0, 1), (-6.0, -0.5), (1.0, 8.0), ANY),
    ("blush", LIGHT, ANY, (1.5, 6.0), ANY),
    ("effort", (0, 1), ANY, (1.0, 6.0), ANY),
    ("pallor", EVERY, (0.5, 6.0), ANY, (0.3, 4.0)),
    ("pallor", (0, 1), ANY, (-6.0, -0.4), ANY),
    ("cold", EVERY, (-2.0, 1.5), (-6.0, -0.5), (-3.0, 0.3)),
    ("soothe", LIGHT, (0.0, 2.0), (-4.0, -0.5), ANY),
    ("freckles", EVERY, (-9.0, -1.0), ANY, ANY),
    ("tired-eyes", EVERY, (-5.0, -0.1), ANY, (-4.0, -0.2)),
    ("bruise-red", LIGHT, (-8.0, -2.0), (1.5, 8.0), ANY),
    ("bruise-blue", EVERY, (-9.0, -1.0), ANY, (-8.0, -1.0)),
    ("bruise-yellow", (0, 1), ANY, ANY, (1.5, 9.0)),
]


@pytest.fixture(scope="module")
def faces(shared_data):
    return list(tried(THREE))


@pytest.mark.parametrize(("name", "which", "lightness", "red", "yellow"), PROMISES)
def test_promises(faces, name, which, lightness, red, yellow):
    for number in which:
        middle, _, _ = difference(faces[number], name)
        for found, (low, high) in zip(middle, (lightness, red, yellow), strict=True):
            assert low <= found <= high, f"{faces[number].name}: {middle.round(1)}"


def test_every_preset_has_a_promise_or_a_table():
    assert {name for name, *_ in PROMISES} <= set(expected()) <= set(presets.names())


def test_bruises_go_from_red_over_blue_to_yellow(faces):
    light = faces[0]
    names = ("red", "blue", "green", "yellow")
    found = {stage: difference(light, f"bruise-{stage}")[0] for stage in names}
    assert found["red"][1] > found["blue"][1] > found["yellow"][1]
    assert found["blue"][2] < found["red"][2] < found["green"][2] < found["yellow"][2]


def test_a_painted_mask_takes_the_place_of_blotches(faces):
    skin = faces[0].skin
    where = (skin.mask > 0) * 1.0
    where[: skin.shape[0] // 2] = 0
    found = skin.apply(presets.bruise_blue, where)
    changed = found.blood != skin.blood
    assert not changed[where == 0].any()
    assert changed[(where > 0) & (skin.blood > 0.001) & (skin.blood < 0.1)].mean() > 0.95
