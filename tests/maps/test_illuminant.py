"""Captures under other lights: estimated under D65, given back under their own."""

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.colour import LINEAR, delta_e, light_conversion, reflectance_to_rgb
from cutis.maps import estimate, load_maps
from cutis.optics import ALIAGA2022, WAVELENGTHS
from cutis.report import report
from cutis.textures import Texture

SKIN = np.array([0.03, 0.025, 90.0, 0.6, 0.75])


@pytest.fixture
def under_a():
    """(4, 5, 3) of one skin, more and less melanin, seen under A."""
    skins = np.tile(SKIN, (4, 5, 1))
    skins[..., 0] *= np.linspace(0.8, 1.2, 20).reshape(4, 5)
    spectra = albedo_space(ALIAGA2022).reflectance(skins)
    return reflectance_to_rgb(spectra, WAVELENGTHS, "A").astype(np.float32)


def test_models_see_the_capture_under_d65(under_a):
    skin = estimate(under_a, illuminant="A", model="aliaga2022-exact")
    converted = under_a @ light_conversion("A").T.astype(np.float32)
    plain = estimate(converted, model="aliaga2022-exact")
    np.testing.assert_allclose(skin.parameters(), plain.parameters(), rtol=1e-3)
    assert delta_e(skin.model_albedo, under_a).max() < 0.5  # back under A
    assert delta_e(plain.model_albedo, under_a).min() > 1
    assert report(skin)["calibration"]["illuminant"] == "A"


def test_what_is_not_edited_comes_back_bit_for_bit(under_a):
    texture = Texture(under_a, ("R", "G", "B"), LINEAR)
    skin = estimate(texture, illuminant="FL11", white=(0.9, 1.0, 1.1))
    np.testing.assert_array_equal(skin.albedo(), under_a)
    np.testing.assert_array_equal(skin.multiply(melanin=1.0).retouch(texture).pixels, under_a)


def test_edits_come_back_under_the_light_of_the_capture(under_a):
    """More melanin, seen under A, against the exact spectra of the estimate."""
    skin = estimate(under_a, illuminant="A", model="aliaga2022-exact")
    edited = skin.multiply(melanin=2.0)
    before, after = (
        albedo_space(ALIAGA2022).rgb(maps.parameters()) @ np.linalg.inv(light_conversion("A")).T
        for maps in (skin, edited)
    )
    np.testing.assert_allclose(edited.albedo(), under_a * after / before, rtol=2e-3)


def test_the_light_is_kept_with_the_maps(under_a, tmp_path):
    skin = estimate(under_a, illuminant="FL2", white=(1.1, 1.0, 0.9))
    skin.save(tmp_path / "face.skin.exr")
    again = load_maps(tmp_path / "face.skin.exr")
    assert again.calibration == skin.calibration
    np.testing.assert_array_equal(again.model_albedo, skin.model_albedo)


def test_d65_changes_nothing(under_a):
    plain, named = estimate(under_a), estimate(under_a, illuminant="d65")
    assert named.calibration == plain.calibration
    np.testing.assert_array_equal(plain.parameters(), named.parameters())
