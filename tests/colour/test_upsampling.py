"""Upsampling by Mallett and Yuksel, and colours from light to light."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, uniform
from cutis.colour import (
    delta_e,
    is_skin_colour,
    light_conversion,
    mallett_basis,
    reflectance_to_rgb,
    upsample,
)
from cutis.colour.observer import illuminant_names, wavelengths
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, WAVELENGTHS


def test_the_basis_is_the_published_one():
    from colour.recovery import MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019, RGB_to_sd_Mallett2019

    published = MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    assert np.array_equal(published.wavelengths, wavelengths())
    np.testing.assert_allclose(mallett_basis(), published.values, rtol=1e-14)
    rgb = np.array([0.5, 0.35, 0.27])
    np.testing.assert_allclose(upsample(rgb), RGB_to_sd_Mallett2019(rgb).values, atol=1e-7)


def test_the_basis_adds_up_to_white_and_stays_a_reflectance():
    basis = mallett_basis()
    np.testing.assert_allclose(basis.sum(axis=1), 1, atol=1e-5)
    assert basis.min() > -1e-6
    assert basis.max() < 1 + 1e-6


@pytest.mark.parametrize("light", illuminant_names())
def test_round_trip_and_white(light):
    rgb = np.random.default_rng(2).uniform(0.05, 0.9, (50, 3))
    again = reflectance_to_rgb(upsample(rgb, light), wavelengths(), light)
    np.testing.assert_allclose(again, rgb, atol=1e-9)
    np.testing.assert_allclose(light_conversion(light).sum(axis=1), 1, atol=2e-9)


@pytest.mark.parametrize("peak", [589.0, 450.0])
def test_lights_of_one_colour_are_refused(peak, tmp_path):
    """Under a sodium line a white has no blue, and no gain can give it any."""
    lamp = tmp_path / "line.csv"
    lamp.write_text("".join(f"{w},{np.exp(-(((w - peak) / 4) ** 2))}\n" for w in wavelengths()))
    with pytest.raises(CutisError, match=r"line.csv has too little (blue|green)") as caught:
        light_conversion(str(lamp))
    assert "\n" not in str(caught.value)


def test_conversion_is_upsampling_and_summing():
    rgb = np.random.default_rng(3).uniform(0.05, 0.9, (20, 3))
    there = reflectance_to_rgb(upsample(rgb, "A"), wavelengths(), "FL11")
    np.testing.assert_allclose(rgb @ light_conversion("A", "FL11").T, there, atol=1e-12)
    np.testing.assert_array_equal(light_conversion("D65"), np.eye(3))


@pytest.mark.parametrize("light", ["A", "FL2", "FL11", "LED-B3", "LED-V1", "D65-prime"])
def test_skins_come_closer_to_their_colour_under_d65(light):
    space = albedo_space(ALIAGA2022)
    skins = uniform(4000, 1)
    truth = space.rgb(skins)
    skins, truth = skins[is_skin_colour(truth)], truth[is_skin_colour(truth)]
    seen = reflectance_to_rgb(space.reflectance(skins), WAVELENGTHS, light)
    before, after = delta_e(seen, truth), delta_e(seen @ light_conversion(light).T, truth)
    assert after.mean() < 0.75 * before.mean()
