"""RGB spaces against OpenColorIO's and colour-science's."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour.spaces import ALIASES, D65, SPACES, RGBSpace, chromaticities_of, rgb_space
from cutis.errors import CutisError

OCIO = {
    "sRGB": "sRGB Encoded Rec.709 (sRGB)",
    "linear": "Linear Rec.709 (sRGB)",
    "ACEScg": "ACEScg",
    "Display P3": "sRGB Encoded P3-D65",
    "Rec.2020": "Linear Rec.2020",
}


@pytest.mark.parametrize("space", SPACES, ids=lambda space: space.name)
def test_against_opencolorio(space):
    """Through OpenImageIO's built-in configuration, both ways."""
    rgb = np.random.default_rng(1).uniform(0.01, 0.9, (1, 50, 3)).astype(np.float32)
    buffer = oiio.ImageBuf(oiio.ImageSpec(50, 1, 3, "float"))
    buffer.set_pixels(oiio.ROI(), rgb)
    there = oiio.ImageBufAlgo.colorconvert(buffer, OCIO[space.name], OCIO["linear"])
    assert not there.has_error, there.geterror()
    np.testing.assert_allclose(space.to_linear_srgb(rgb), there.get_pixels(oiio.FLOAT), atol=2e-5)


@pytest.mark.parametrize("space", SPACES, ids=lambda space: space.name)
def test_round_trip_and_white(space):
    rgb = np.random.default_rng(2).uniform(0, 1, (200, 3))
    again = space.to_linear_srgb(space.from_linear_srgb(rgb))
    np.testing.assert_allclose(again, rgb, atol=1e-12)
    np.testing.assert_allclose(space.to_linear_srgb(np.ones(3)), 1, atol=1e-9)


def test_names_and_aliases():
    assert rgb_space("acescg") is rgb_space("lin_ap1")
    assert {rgb_space(alias).name for alias in ALIASES} == {space.name for space in SPACES}
    with pytest.raises(CutisError, match="ACEScg"):
        rgb_space("ProPhoto")


@pytest.mark.parametrize("space", SPACES, ids=lambda space: space.name)
def test_chromaticities_of_a_matrix(space):
    """Of spaces under D65 their own; of others those that give the same colours."""
    numbers = chromaticities_of(space.matrix)
    if space.white == D65:
        np.testing.assert_allclose(numbers, space.chromaticities, atol=1e-12)
    xy = [tuple(numbers[i : i + 2]) for i in range(0, 8, 2)]
    np.testing.assert_allclose(RGBSpace("", tuple(xy[:3]), xy[3]).matrix, space.matrix, atol=1e-12)


def test_to_xyz_against_colour_science():
    import colour

    theirs = colour.RGB_COLOURSPACES["ACEScg"]
    ours = rgb_space("ACEScg")
    np.testing.assert_allclose(ours.to_xyz(), theirs.matrix_RGB_to_XYZ, atol=1e-6)
    white = colour.xy_to_XYZ(theirs.whitepoint)
    d50 = np.array([0.9642, 1.0, 0.8249])
    adapted = colour.adaptation.matrix_chromatic_adaptation_VonKries(white, d50, "Bradford")
    np.testing.assert_allclose(ours.to_xyz(d50), adapted @ theirs.matrix_RGB_to_XYZ, atol=1e-6)
