"""Views are what `cutis edit` gives: at the face's own size and, nearly, at smaller ones."""

import numpy as np
import pytest

from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.looks import Look, presets
from cutis.maps import load_skin
from cutis.studio.drawing import Region
from cutis.studio.state import State

LOOKS = {
    "plain": {"layers": [{"edits": [
        {"do": "multiply", "map": "melanin", "by": 1.8},
        {"do": "offset", "map": "blood", "by": 0.01},
    ]}]},
    "half": {"layers": [{"amount": 0.4, "edits": [{"do": "set", "map": "thickness", "to": 120}]}]},
    "range": {"layers": [{
        "edits": [{"do": "multiply", "map": "blood", "by": 2}],
        "mask": [{"part": "range", "map": "melanin", "above": ["p40", "p60"]}],
    }]},
    "rare": {"layers": [{"edits": [{"do": "offset", "map": "bilirubin", "by": 0.05}]}]},
    "detail": {"layers": [{"edits": [
        {"do": "contrast", "map": "melanin", "by": 0.3, "about": "local", "radius": 0.02},
    ]}]},
}  # fmt: skip


def look(document):
    import json

    return Look.of_text(json.dumps({"cutis_look": 1, **document}), "test")


def whole(workshop, scale=1.0):
    height, width = workshop.face.shape
    return Region(0, 0, width, height, scale)


@pytest.fixture(scope="module")
def skin(workshop):
    return load_skin(workshop.face.maps)


@pytest.mark.parametrize("name", LOOKS)
def test_a_view_at_full_size_is_the_edit(workshop, skin, name):
    wanted = look(LOOKS[name])
    drawn = workshop.drawer.edited(whole(workshop), wanted)
    assert drawn.place == [0, 0, 240, 200]
    want = skin.apply(wanted).albedo()
    assert np.abs(want - skin.source).max() > 0.005
    np.testing.assert_allclose(drawn.colours, want, rtol=2e-5, atol=1e-6)


@pytest.mark.parametrize("name", LOOKS)
def test_a_part_is_cut_out_of_the_whole(workshop, name):
    wanted = look(LOOKS[name])
    part = workshop.drawer.edited(Region(31.5, 20.2, 90, 77.7, 2.0), wanted)
    left, top, right, bottom = part.place
    assert (left, top, right, bottom) == (31, 20, 90, 78)
    every = workshop.drawer.edited(whole(workshop), wanted).colours
    np.testing.assert_allclose(part.colours, every[top:bottom, left:right], rtol=2e-5, atol=1e-6)


def test_other_lights_are_those_of_edit(workshop, skin):
    wanted = look(LOOKS["plain"])
    drawn = workshop.drawer.edited(whole(workshop), wanted, light="A")
    np.testing.assert_allclose(drawn.colours, skin.apply(wanted).albedo("A"), rtol=1e-5, atol=1e-6)


def test_a_smaller_view_is_near_the_edit_made_smaller(workshop, skin):
    """A quarter of the texels, colours of means instead of means of colours."""
    wanted = look(LOOKS["plain"])
    drawn = workshop.drawer.edited(whole(workshop, 0.5), wanted).colours
    every = skin.apply(wanted).albedo()
    mean = every.reshape(100, 2, 120, 2, 3).mean((1, 3))
    error = delta_e(drawn, mean)
    assert np.percentile(error, 95) < 0.5
    assert np.median(error) < 0.1


def test_without_edits_it_is_the_capture(workshop):
    drawn = workshop.drawer.edited(whole(workshop), State().look)
    assert np.array_equal(drawn.colours, workshop.face.levels.all[0].colours)


def test_texels_that_do_not_change_are_those_of_the_capture(workshop):
    wanted = look(LOOKS["range"])
    drawn = workshop.drawer.edited(whole(workshop), wanted).colours
    same = (drawn == workshop.face.levels.all[0].colours).all(-1)
    assert 0.2 < same.mean() < 0.7


def test_views_without_edges_are_refused(workshop):
    with pytest.raises(CutisError, match="finite"):
        workshop.drawer.edited(Region(float("nan"), 0, 10, 10, 1), presets.tanning)
