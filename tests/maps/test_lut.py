"""Edits as LUTs: applied by OpenColorIO, against the edit itself."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.albedo import albedo_space, halton
from cutis.colour import delta_e, is_skin_colour
from cutis.colour.spaces import SPACES, rgb_space
from cutis.errors import CutisError
from cutis.figures.subjects import every_face
from cutis.maps import edit_lut, estimate, presets
from cutis.textures import write_lut


def applied(path, stored):
    """(n, 3) values through a LUT file, as OpenColorIO reads it."""
    buffer = oiio.ImageBuf(oiio.ImageSpec(len(stored), 1, 3, "float"))
    buffer.set_pixels(oiio.ROI(), stored[None].astype(np.float32))
    result = oiio.ImageBufAlgo.ociofiletransform(buffer, str(path))
    assert not result.has_error, result.geterror()
    return result.get_pixels(oiio.FLOAT)[0]


@pytest.fixture(scope="module")
def skins():
    rgb = albedo_space().rgb(halton(6000, 3))
    return rgb[is_skin_colour(rgb) & (rgb > 0.002).all(axis=1)]


@pytest.mark.parametrize("kind", ["cube", "clf"])
@pytest.mark.parametrize("space", [space.name for space in SPACES])
def test_a_file_is_the_edit(kind, space, skins, tmp_path):
    edits = presets.melanin_more
    lut = edit_lut(edits, 49, space)
    write_lut(tmp_path / f"edit.{kind}", lut.table, lut.shaper, lut.title)
    stored = rgb_space(space).from_linear_srgb(skins)
    found = rgb_space(space).to_linear_srgb(applied(tmp_path / f"edit.{kind}", stored))
    real = estimate(skins[None]).apply(edits).albedo()[0]
    error = delta_e(found, real)
    assert np.median(error) < 0.15
    assert np.percentile(error, 95) < (0.5 if space in ("sRGB", "linear", "Display P3") else 1.0)


@pytest.mark.parametrize("name", ["tanning", "flushing", "melanin_triple"])
def test_faces_of_the_larger_data(name, shared_data, tmp_path):
    """Captures, white-balanced, 65 nodes, sRGB: 99 % of skin colours within half a ΔE00."""
    edits = getattr(presets, name)
    chosen = ("bioskin_capture1", "leeperrysmith_color", "reom_light_face")
    for face, colours in every_face(shared_data, 1500):
        if face not in chosen:
            continue
        skin = estimate(colours[None], white="auto")
        lut = edit_lut(edits, 65, "sRGB", calibration=skin.calibration)
        write_lut(tmp_path / "edit.cube", lut.table, lut.shaper, lut.title)
        stored = rgb_space("sRGB").from_linear_srgb(colours)
        found = rgb_space("sRGB").to_linear_srgb(applied(tmp_path / "edit.cube", stored))
        real = skin.apply(edits).albedo()[0]
        inside = (colours < 1).all(axis=1)
        assert np.percentile(delta_e(found, real)[inside], 99) < 0.5, face


def test_colours_that_are_no_skin_pass_through(tmp_path):
    lut = edit_lut(presets.melanin_fivefold, 33)
    write_lut(tmp_path / "edit.cube", lut.table, lut.shaper, lut.title)
    far = np.array([[0, 0, 1], [0, 1, 0], [1, 1, 1], [0.2, 0.6, 0.9], [0.5, 0.5, 0.5]])
    np.testing.assert_allclose(applied(tmp_path / "edit.cube", far), far, atol=1e-5)


def test_the_transition_is_smooth():
    """Along a line from skin to blue no step of the result is much larger than the line's own."""
    lut = edit_lut(presets.melanin_triple, 65)
    nodes = lut.table[40, 30, :]
    steps = np.abs(np.diff(nodes, axis=0)).max(axis=1)
    assert steps.max() < 6 / 64


def test_no_amount_is_no_edit(tmp_path):
    lut = edit_lut(presets.melanin_triple, 9, amount=0.0)
    grid = np.linspace(0, 1, 9)
    even = np.stack(np.meshgrid(grid, grid, grid, indexing="ij"), -1)
    np.testing.assert_allclose(lut.table, even, atol=1e-6)


@pytest.mark.parametrize(
    ("how", "what"),
    [
        ({"size": 1}, "2 to 129"),
        ({"size": 130}, "2 to 129"),
        ({"space": "XYZ"}, "unknown colour space"),
        ({"amount": 2.0}, "amount"),
        ({"edits": presets.vitiligo}, "places"),
    ],
)
def test_bad_input_is_one_line(how, what):
    with pytest.raises(CutisError, match=what) as caught:
        edit_lut(**{"edits": presets.tanning, "size": 5, **how})
    assert "\n" not in str(caught.value)


def test_other_extensions(tmp_path):
    lut = edit_lut(presets.tanning, 2)
    with pytest.raises(CutisError, match=r"\.cube or \.clf"):
        write_lut(tmp_path / "edit.lut", lut.table, lut.shaper, lut.title)
