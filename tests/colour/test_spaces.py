"""RGB spaces against OpenColorIO's and colour-science's."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour.spaces import ALIASES, SPACES, rgb_space
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
