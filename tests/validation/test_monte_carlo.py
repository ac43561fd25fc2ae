"""The walk against the exact solver over the whole albedo space, and against published numbers.

Levels were fixed before the first run. More photons per skin: studies/monte_carlo_accuracy.py.
"""

import numpy as np
import pytest
from scipy.stats import chi2, norm

from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates
from cutis.transport import Layer, fresnel_reflectance, two_layer_albedo, walk
from cutis.transport.monte_carlo import walk_stacks

SKINS = 200
"""Random skins, each at a random wavelength, per dimension and boundary."""
PHOTONS = 20_000
"""Per skin."""
LEVEL = 0.01
"""Chance that a right walk fails any of the tests of this page, were its seed not fixed."""
TESTS = 2 * 4 + 5


@pytest.mark.parametrize(
    ("dimension", "index"),
    [
        (2, 1.0),
        (3, 1.4),
        *(pytest.param(*how, marks=pytest.mark.long) for how in [(2, 1.4), (3, 1.0)]),
    ],
)
def test_random_skins(dimension, index):
    """Every skin within the walk's own error (Bonferroni), and all of them together (χ²)."""
    rng = np.random.default_rng(10 * dimension + int(index > 1))
    melanin, blood, thickness, eumelanin, oxygenation = from_coordinates(rng.random((SKINS, 5))).T
    band, each = rng.integers(0, len(WAVELENGTHS), SKINS), np.arange(SKINS)
    lam = WAVELENGTHS[band]
    epidermis = ALIAGA2022.epidermis_absorption(melanin, eumelanin, WAVELENGTHS)[each, band]
    dermis = ALIAGA2022.dermis_absorption(blood, oxygenation, WAVELENGTHS)[each, band]
    mu_s, g = ALIAGA2022.scattering(lam), ALIAGA2022.anisotropy(lam)
    found = walk_stacks(
        np.stack([epidermis, dermis], -1),
        mu_s[:, None],
        g[:, None],
        np.stack([thickness * 1e-4, np.full(SKINS, np.inf)], -1),
        photons=PHOTONS,
        seed=2022,
        dimension=dimension,
        refractive_index=index,
    )
    how = {"dimension": dimension, "refractive_index": index}
    exact = np.array(
        [
            two_layer_albedo(e, d, t, float(s), float(a), **how).item()
            for e, d, t, s, a in zip(epidermis, dermis, thickness, mu_s, g, strict=True)
        ]
    )
    z = (found.reflected - exact) / found.reflected_error
    assert np.all(found.reflected_error < 3.6e-3)
    assert np.abs(z).max() < norm.isf(LEVEL / TESTS / (2 * SKINS)), z
    assert np.sum(z**2) < chi2.isf(LEVEL / TESTS, SKINS), z


def test_dark_epidermis_over_clear_dermis():
    """Where a walk that forgets to stop photons at the interface is 1e-3 wrong."""
    found = walk([Layer(300.0, 200.0, 0.8, 20e-4), Layer(0.5, 200.0, 0.8)], photons=600_000, seed=1)
    exact = two_layer_albedo(300.0, 0.5, 20.0, 200.0, 0.8).item()
    assert found.reflected_error < 4e-4
    assert abs(found.reflected - exact) < norm.isf(LEVEL / TESTS / 2) * found.reflected_error


def test_slab_of_van_de_hulst():
    """Van de Hulst 1980, as MCML quotes him [wang1992mcml]; T with the unscattered light."""
    found = walk(
        [Layer(10.0, 90.0, 0.75, 0.02)], photons=500_000, dimension=3, incidence=1.0, seed=80
    )
    bound = norm.isf(LEVEL / TESTS / 4)
    assert abs(found.reflected - 0.09739) < bound * found.reflected_error
    assert abs(found.transmitted - 0.66096) < bound * found.transmitted_error


def test_half_space_of_giovanelli():
    """Giovanelli 1955, n = 1.5: total reflectance 0.2600, the surface's 4 % included."""
    found = walk(
        [Layer(10.0, 90.0)],
        photons=400_000,
        dimension=3,
        refractive_index=1.5,
        incidence=1.0,
        seed=55,
    )
    surface = float(fresnel_reflectance(1.0, 1.5))
    total = surface + (1 - surface) * found.reflected
    assert abs(total - 0.2600) < norm.isf(LEVEL / TESTS / 2) * found.reflected_error + 5e-5


def test_three_layers_of_mcml():
    """The sample output that ships with MCML, a million photons; both walks have their errors."""
    layers = [Layer(1.0, 100.0, 0.9, 0.1), Layer(1.0, 10.0, 0.0, 0.1), Layer(2.0, 10.0, 0.7, 0.2)]
    found = walk(
        layers, photons=400_000, dimension=3, refractive_index=1.37, incidence=1.0, seed=95
    )
    entered = 1 - float(fresnel_reflectance(1.0, 1.37))
    ours = entered * np.array([found.reflected, found.transmitted, *found.absorbed])
    error = entered * np.array(
        [found.reflected_error, found.transmitted_error, *found.absorbed_error]
    )
    printed = np.array([0.237544, 0.0964896, 0.2612, 0.1488, 0.2316])
    z = (ours - printed) / np.hypot(error, error * np.sqrt(400_000 / 1_000_000))
    assert np.abs(z).max() < norm.isf(LEVEL / TESTS / 10), z


@pytest.mark.parametrize(
    ("layers", "expected"),
    [
        ([Layer(10.0, 90.0, 0.0)], 0.36959),  # n = 1.5, flatland
        ([Layer(10.0, 90.0, 0.75, 0.02)], 0.14334),  # n = 1.4 slab, flatland
    ],
)
def test_flatland_with_a_dielectric_boundary(layers, expected):
    """Values of two agreeing methods, computed outside this project to 1e-5."""
    index = 1.5 if np.isinf(layers[0].depth) else 1.4
    found = walk(layers, photons=400_000, refractive_index=index, incidence=1.0, seed=14)
    surface = float(fresnel_reflectance(1.0, index))
    total = surface + (1 - surface) * found.reflected
    assert abs(total - expected) < norm.isf(LEVEL / TESTS / 4) * found.reflected_error + 1e-5
