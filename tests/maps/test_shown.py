"""How maps, textures and models show themselves: one line, and a thumbnail in notebooks."""

import numpy as np

import cutis
from cutis.colour import SRGB
from cutis.textures import Texture


def test_one_line_each(face_rgb, face_mask):
    codes = np.rint(255 * np.clip(face_rgb, 0, 1)).astype(np.uint8)
    texture = Texture(codes, ("R", "G", "B"), SRGB)
    skin = cutis.estimate(face_rgb, face_mask)
    edited = skin.multiply(melanin=2)
    for what, words in (
        (texture, "32 × 24 uint8 R,G,B in sRGB"),
        (skin, "32 × 24 texels, 50 % skin, by measured2026"),
        (edited, "1 edits"),
        (skin.model, "model measured2026"),
    ):
        text = repr(what)
        assert words in text
        assert "\n" not in text
        assert len(text) < 200
    for what in (texture, skin, edited):
        html = what._repr_html_()
        assert html.startswith("<figure")
        assert "data:image/png;base64," in html
        assert len(html) < 20_000


def test_arrays_are_welcome_where_numbers_are(face_rgb, face_mask):
    skin = cutis.estimate(face_rgb, face_mask)
    ramp = np.linspace(0.5, 2, skin.blood.size, dtype=np.float32).reshape(skin.shape)
    np.testing.assert_allclose(skin.multiply(blood=ramp).blood, np.clip(skin.blood * ramp, 0, 1))
    other = skin.multiply(blood=1.5)
    inside = skin.mask > 0
    np.testing.assert_array_equal(
        skin.replace(blood=other.blood).blood[inside], other.blood[inside]
    )
    rows = slice(3, 9)
    np.testing.assert_array_equal(
        skin.multiply(blood=ramp).rows(rows).blood, skin.multiply(blood=ramp).blood[rows]
    )


def test_lists_of_colours_have_a_way(face_rgb):
    import pytest

    with pytest.raises(cutis.CutisError, match=r"cutis\.load_model\(\)\.encode"):
        cutis.estimate(face_rgb[0])
    assert cutis.load_model().encode(face_rgb[0]).shape == (32, 5)
