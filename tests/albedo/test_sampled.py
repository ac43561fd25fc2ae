"""The albedo space between its wavelengths, against the exact solver."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.albedo.sampled import SampledSpace
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, GITLINA2020, WAVELENGTHS
from cutis.transport import two_layer_albedo


def exact(skins, wavelengths):
    """(n, w) albedo by the solver."""
    tissue = ALIAGA2022
    return np.array(
        [
            [
                two_layer_albedo(
                    tissue.epidermis_absorption(x[0], x[3], lam),
                    tissue.dermis_absorption(x[1], x[4], lam),
                    [x[2]],
                    float(tissue.scattering(lam)),
                    float(tissue.anisotropy(lam)),
                    dimension=2,
                    count=24,
                )[0, 0, 0]
                for lam in wavelengths
            ]
            for x in skins
        ]
    )


def test_between_bands_transport_is_blended_not_spectra():
    wavelengths = np.array([383.0, 415.5, 542.0, 577.0, 605.0, 733.0])
    skins = halton(40, seed=3)
    found = SampledSpace(albedo_space(ALIAGA2022), wavelengths).reflectance(skins)
    error = np.abs(found - exact(skins, wavelengths))
    usual = skins[:, 1] < 0.5
    assert error[usual].max() < 1e-4
    assert error.max() < 1e-3
    whole = albedo_space(ALIAGA2022).reflectance(skins)
    nodes = np.array([np.interp(wavelengths, WAVELENGTHS, spectrum) for spectrum in whole])
    assert np.abs(nodes - found).max() > 5e-3  # what interpolating spectra would cost


def test_at_the_tables_wavelengths_it_is_the_table():
    skins = halton(200, seed=1)
    found = SampledSpace(albedo_space(ALIAGA2022), WAVELENGTHS).reflectance(skins)
    np.testing.assert_allclose(found, albedo_space(ALIAGA2022).reflectance(skins), atol=2e-6)


def test_slopes_are_those_of_the_solver():
    wavelengths = np.array([440.0, 545.0, 577.0, 650.0])
    skins = np.array([[0.03, 0.02, 80.0, 0.6, 0.7], [0.2, 0.05, 150.0, 0.3, 0.4]])
    _, slopes = SampledSpace(albedo_space(ALIAGA2022), wavelengths).gradient(skins)
    for p, step in enumerate([1e-4, 1e-4, 0.3, 1e-2, 1e-2]):
        move = np.eye(5)[p] * step
        difference = (exact(skins + move, wavelengths) - exact(skins - move, wavelengths)) / 2
        np.testing.assert_allclose(slopes[..., p] * step, difference, rtol=0.01, atol=2e-6)


def test_every_parameter_of_a_tissue_counts():
    space = albedo_space(GITLINA2020)
    skins = np.array([[0.03, 0.02, 0.5, 0.002]])  # melanin, blood, eumelanin, epidermal blood
    found, slopes = SampledSpace(space, WAVELENGTHS).gradient(skins)
    np.testing.assert_allclose(found, space.reflectance(skins), atol=2e-6)
    more = SampledSpace(space, WAVELENGTHS).reflectance(skins + np.array([0, 0, 0, 1e-4]))
    np.testing.assert_allclose((more - found)[0], 1e-4 * slopes[0, :, 3], atol=3e-6)
    assert slopes.shape == (1, 41, 4)


@pytest.mark.parametrize("wavelengths", [[], [379.0, 500.0], [500.0, 781.0], [np.nan]])
def test_wavelengths_outside_are_refused(wavelengths):
    with pytest.raises(CutisError, match="380 to 780 nm"):
        SampledSpace(albedo_space(ALIAGA2022), wavelengths)
