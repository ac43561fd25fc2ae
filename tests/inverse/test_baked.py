"""The baked inverse: its kernel against NumPy, units, round trip."""

from importlib import resources

import numpy as np
import pytest

from cutis.inverse.baked import Baked, load_baked, save_baked
from cutis.kernels.splines import basis
from cutis.optics import PARAMETERS, from_coordinates

RNG = np.random.default_rng(8)


@pytest.fixture(scope="module")
def baked() -> Baked:
    weights = resources.files("cutis.data").joinpath("weights", "aliaga2022-exact.npz")
    with resources.as_file(weights) as file:
        return load_baked(file)


def colours(count: int) -> np.ndarray:
    """Some skin colours, and some that no skin has."""
    a = RNG.uniform(0.3, 0.95, count)
    b, c = RNG.uniform(0.45, 0.95, count), RNG.uniform(0.05, 0.6, count)
    green = a**4
    rgb = np.stack([green * b / (1 - b), green, green * c / (1 - c)], axis=-1)
    rgb[:3] = [[0, 0, 0], [-1, 0.2, 5], [1, 1, 1]]
    return rgb.astype(np.float32)


def plain(baked: Baked, rgb: np.ndarray) -> np.ndarray:
    """(n, 5) coordinates by NumPy, in float64."""
    red, green, blue = np.maximum(rgb.astype(float), 1e-6).T
    chart = green**0.25, red / (red + green), blue / (blue + green)
    ends = baked.chart.low, baked.chart.high, baked.chart.cells
    bases = [
        basis((x - low) / (high - low), cells)
        for x, low, high, cells in zip(chart, *ends, strict=True)
    ]
    return np.einsum("na,nb,nc,abcp->np", *bases, baked.coefficients, optimize=True).clip(0, 1)


def test_coordinates_are_the_plain_sum(baked):
    rgb = colours(700)
    np.testing.assert_allclose(baked(rgb), plain(baked, rgb), atol=3e-5)


def test_units_are_those_of_the_coordinates(baked):
    rgb = colours(700)
    skins = baked.skins(rgb)
    np.testing.assert_allclose(skins, from_coordinates(baked(rgb).astype(float)), rtol=2e-6)
    for i, known in enumerate(PARAMETERS):
        assert skins[:, i].min() >= np.float32(known.low)
        assert skins[:, i].max() <= np.float32(known.high)


def test_any_number_of_colours_even_those_that_are_no_numbers(baked):
    rgb = colours(300)
    whole = baked.skins(rgb)
    assert baked.skins(rgb[:0]).shape == (0, 5)
    np.testing.assert_array_equal(baked.skins(rgb[:1]), whole[:1])
    np.testing.assert_array_equal(baked.skins(rgb[100:]), whole[100:])
    spoilt = rgb.copy()
    spoilt[7], spoilt[9] = np.nan, np.inf
    good = np.delete(np.arange(300), [7, 9])
    np.testing.assert_array_equal(baked.skins(spoilt)[good], whole[good])


def test_round_trip(baked, tmp_path):
    save_baked(baked, tmp_path / "again.npz")
    again = load_baked(tmp_path / "again.npz")
    assert np.abs(again.coefficients - baked.coefficients).max() < 1e-4
