"""The albedo space: RGB is its spectra seen under D65, and its slopes are those of the solver."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, uniform
from cutis.colour import spectrum_to_rgb
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, NAMES, PARAMETERS, WAVELENGTHS
from cutis.transport import two_layer_albedo

SPACE = albedo_space(ALIAGA2022)
SKINS = uniform(500, seed=11)


def test_rgb_is_the_spectrum_under_d65():
    spectra = SPACE.reflectance(SKINS).astype(float)
    np.testing.assert_allclose(SPACE.rgb(SKINS), spectra @ spectrum_to_rgb(WAVELENGTHS), atol=1e-6)


def test_albedos_are_albedos():
    spectra = SPACE.reflectance(uniform(20_000, seed=12))
    assert np.all(spectra >= -1e-5)
    assert np.all(spectra <= 1)
    assert np.all(SPACE.rgb(SKINS) > -1e-3)


def test_shapes_and_types():
    grid = SKINS[:60].reshape(4, 15, 5)
    assert SPACE.reflectance(grid).shape == (4, 15, 41)
    assert SPACE.rgb(grid).shape == (4, 15, 3)
    colour, slope = SPACE.rgb_gradient(grid)
    assert colour.shape == (4, 15, 3)
    assert slope.shape == (4, 15, 3, 5)
    assert SPACE.rgb(SKINS[0]).shape == (3,)
    assert SPACE.rgb(np.empty((0, 5))).shape == (0, 3)
    assert SPACE.reflectance(grid).dtype == SPACE.rgb(grid).dtype == np.float32
    np.testing.assert_array_equal(SPACE.rgb(grid).reshape(-1, 3), SPACE.rgb(SKINS[:60]))
    np.testing.assert_allclose(colour, SPACE.rgb(grid), atol=1e-6)


def test_spectra_into_an_array_that_is_there():
    out = np.full((10, 50, 41), np.nan, dtype=np.float32)
    assert SPACE.reflectance(SKINS.reshape(10, 50, 5), out) is out
    np.testing.assert_array_equal(out.reshape(-1, 41), SPACE.reflectance(SKINS))
    for other in (out.astype(float), out[:9], out.transpose(1, 0, 2), out[..., ::-1]):
        with pytest.raises(CutisError, match="float32 array of shape"):
            SPACE.reflectance(SKINS.reshape(10, 50, 5), other)


def test_one_space_per_tissue():
    assert albedo_space(ALIAGA2022) is albedo_space(ALIAGA2022)


def exact_slope(skin, steps):
    """(3, 5) central differences of the exact solver's RGB, by parameter."""
    lam = WAVELENGTHS
    v_m, v_b, t, phi, oxy = skin
    h = steps
    melanin = np.array([v_m + h[0], v_m - h[0], v_m, v_m, v_m])
    eumelanin = np.array([phi, phi, phi + h[3], phi - h[3], phi])
    blood = np.array([v_b + h[1], v_b - h[1], v_b, v_b, v_b])
    oxygen = np.array([oxy, oxy, oxy + h[4], oxy - h[4], oxy])
    epidermis = ALIAGA2022.epidermis_absorption(melanin, eumelanin, lam)
    dermis = ALIAGA2022.dermis_absorption(blood, oxygen, lam)
    scattering, g = ALIAGA2022.scattering(lam), ALIAGA2022.anisotropy(lam)
    slope = np.empty((41, 5))
    for i in range(41):
        medium = float(scattering[i]), float(g[i])
        by_e = two_layer_albedo(epidermis[:, i], dermis[4:, i], [t], *medium)[:, 0, 0]
        by_d = two_layer_albedo(epidermis[4:, i], dermis[:, i], [t], *medium)[0, :, 0]
        by_t = two_layer_albedo(epidermis[4:, i], dermis[4:, i], [t + h[2], t - h[2]], *medium)
        slope[i] = [
            (by_e[0] - by_e[1]) / (2 * h[0]),
            (by_d[0] - by_d[1]) / (2 * h[1]),
            (by_t[0, 0, 0] - by_t[0, 0, 1]) / (2 * h[2]),
            (by_e[2] - by_e[3]) / (2 * h[3]),
            (by_d[2] - by_d[3]) / (2 * h[4]),
        ]
    return spectrum_to_rgb(WAVELENGTHS).T @ slope


@pytest.mark.parametrize("row", range(8))
def test_slopes_are_those_of_the_solver(row):
    """Per unit of coordinate, where RGB varies by about 1: to 1e-3."""
    u = 0.05 + 0.9 * np.random.default_rng(row).random(5)
    values, per_coordinate = np.empty(5), np.empty(5)
    for i, p in enumerate(PARAMETERS):
        values[i] = p.from_coordinate(u[i])
        low, high = p.low ** (1 / p.root), p.high ** (1 / p.root)
        root = low + u[i] * (high - low)
        per_coordinate[i] = p.root * root ** (p.root - 1) * (high - low)
    expected = exact_slope(values, 1e-3 * per_coordinate) * per_coordinate
    _, slope = SPACE.rgb_gradient(values)
    np.testing.assert_allclose(slope * per_coordinate, expected, atol=1e-3)


def test_directions_that_are_known():
    """More melanin or blood is darker, blood reddens, oxygen brightens red."""
    skin = np.array([0.02, 0.02, 80.0, 0.7, 0.7])
    _, slope = SPACE.rgb_gradient(skin)
    by = dict(zip(NAMES, slope.T, strict=True))
    assert np.all(by["melanin"] < 0)
    assert np.all(by["blood"] < 0)
    assert np.all(by["thickness"] < 0)
    assert by["oxygenation"][0] > 0
    red, green, blue = SPACE.rgb(skin)
    assert red > green > blue


def test_outside_the_range_is_the_end():
    inside = np.array([1.0, 1.0, 250.0, 1.0, 0.999])
    beyond = inside * [1, 1, 2, 1, 1]
    np.testing.assert_array_equal(SPACE.rgb(beyond), SPACE.rgb(inside))
