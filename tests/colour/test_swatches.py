import colour
import numpy as np

from cutis.colour.swatches import MONK, swatch


def test_a_code_is_what_colour_science_decodes():
    for text in MONK:
        codes = colour.notation.HEX_to_RGB(f"#{text}")
        wanted = colour.models.eotf_sRGB(codes)
        np.testing.assert_allclose(swatch(text), wanted, atol=1e-6)


def test_tones_go_from_light_to_dark():
    """But for the third, which is a little lighter than the second."""
    lightness = [float(swatch(text) @ [0.2126, 0.7152, 0.0722]) for text in MONK]
    assert lightness[2:] == sorted(lightness[2:], reverse=True)
    assert lightness[0] > lightness[2] > lightness[1] > lightness[3]
