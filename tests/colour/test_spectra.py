"""Spectra to RGB: white, sums by hand, errors."""

import numpy as np
import pytest

from cutis.colour import illuminant, reflectance_to_rgb, spectrum_to_rgb, spectrum_to_xyz
from cutis.colour.observer import colour_matching, wavelengths
from cutis.colour.spectra import XYZ_TO_SRGB
from cutis.errors import CutisError
from cutis.optics import WAVELENGTHS
from cutis.optics.tables import packaged_table

LIGHTS = [name for name in packaged_table("colour", "illuminants") if name != "lambda_nm"]


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("lam", [WAVELENGTHS, wavelengths(), np.array([400.0, 550.0, 700.0])])
def test_white_is_white(light, lam):
    white = reflectance_to_rgb(np.ones(len(lam)), lam, light)
    np.testing.assert_allclose(white, 1, atol=1e-12)
    grey = reflectance_to_rgb(np.full((2, 3, len(lam)), 0.18), lam, light)
    np.testing.assert_allclose(grey, 0.18, atol=1e-12)
    np.testing.assert_allclose(spectrum_to_xyz(lam, light)[:, 1].sum(), 1, atol=1e-12)


def test_sum_by_hand_at_five_nm():
    """At the table's own wavelengths XYZ = Σ R S x̄ / Σ S ȳ."""
    spectrum = 0.5 + 0.4 * np.sin(wavelengths() / 40)
    power = illuminant("A")[:, None] * colour_matching()
    expected = spectrum @ power / power[:, 1].sum()
    got = spectrum @ spectrum_to_xyz(wavelengths(), "A")
    np.testing.assert_allclose(got, expected, rtol=1e-13)


def test_ten_nm_is_linear_between():
    spectrum = np.random.default_rng(3).random(len(WAVELENGTHS))
    fine = np.interp(wavelengths(), WAVELENGTHS, spectrum)
    np.testing.assert_allclose(
        reflectance_to_rgb(spectrum, WAVELENGTHS),
        reflectance_to_rgb(fine, wavelengths()),
        atol=1e-13,
    )


def test_matrix_from_primaries_and_white():
    """XYZ of Rec.709 primaries scaled to the white (0.3127, 0.3290), inverted [iec61966]."""
    xy = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    columns = np.stack([xy[:, 0] / xy[:, 1], np.ones(3), (1 - xy.sum(1)) / xy[:, 1]])
    white = np.array([0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290])
    to_xyz = columns * np.linalg.solve(columns, white)
    np.testing.assert_allclose(XYZ_TO_SRGB, np.linalg.inv(to_xyz), atol=1e-12)


def test_blood_is_red_and_light_is_not_gained():
    spectrum = np.where(WAVELENGTHS > 600, 0.9, 0.05)
    red, green, blue = reflectance_to_rgb(spectrum, WAVELENGTHS)
    assert red > 0.6 > 0.1 > blue > green > 0


def test_the_cached_matrix_cannot_be_spoiled():
    spectrum_to_xyz(WAVELENGTHS)[:] = 0
    np.testing.assert_allclose(spectrum_to_rgb(WAVELENGTHS).sum(axis=0), 1, atol=1e-12)


@pytest.mark.parametrize("lam", [[], [500.0], [500.0, 500.0], [600.0, 500.0], [500.0, np.nan]])
def test_bad_wavelengths_are_one_line(lam):
    with pytest.raises(CutisError, match="wavelengths") as caught:
        spectrum_to_rgb(lam)
    assert "\n" not in str(caught.value)


def test_unknown_light_is_one_line():
    with pytest.raises(CutisError, match="unknown illuminant"):
        spectrum_to_rgb(WAVELENGTHS, "candle")
