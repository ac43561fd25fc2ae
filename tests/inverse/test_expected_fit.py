"""Fits under an expectation: of skins that scatter otherwise, against SciPy, and when held."""

import numpy as np
from scipy.optimize import least_squares

from cutis.inverse import SpectralFitter
from cutis.inverse.expectation import expected_of
from cutis.optics import ALIAGA2022, MEASURED2026B, from_coordinates

BANDS = np.arange(400.0, 701.0, 10.0)
RHO = 0.028
E = expected_of(MEASURED2026B)


def drawn(count, seed):
    """Skins and scattering as the expectation has them, and their spectra."""
    rng = np.random.default_rng(seed)
    cov = np.linalg.inv(E.precision)
    centre = np.array([*E.centre, 0.0, 0.0])
    z = rng.multivariate_normal(centre, 0.5 * cov, count)
    skins = from_coordinates(1 / (1 + np.exp(-np.clip(z[:, :5], -4, 4))))
    fitter = SpectralFitter(BANDS, MEASURED2026B, specular=RHO)
    return skins, z[:, 5:], fitter.reflectance(skins, z[:, 5:]), fitter


def test_only_this_tissue_has_an_expectation():
    assert expected_of(ALIAGA2022) is None
    assert np.linalg.eigvalsh(E.precision).min() > 0


def test_skins_that_scatter_otherwise_are_explained():
    """Without their own scattering the spectra are off by more than with it."""
    _, hidden, spectra, fitter = drawn(60, 0)
    found = fitter.fit(spectra)
    assert np.median(found.rmse) < 5e-4
    assert found.scattering.shape == (60, 2)
    again = fitter.reflectance(found.values, found.scattering)
    np.testing.assert_allclose(
        np.sqrt(((again - spectra) ** 2).mean(axis=1)), found.rmse, atol=1e-5
    )
    plain = fitter.reflectance(found.values)
    assert np.median(np.sqrt(((plain - spectra) ** 2).mean(axis=1))) > 2 * np.median(found.rmse)
    assert np.corrcoef(hidden[:, 0], found.scattering[:, 0])[0, 1] > 0.5


def test_scattering_of_nothing_else_is_the_tissue():
    skins, hidden, _, fitter = drawn(10, 1)
    np.testing.assert_allclose(
        fitter.reflectance(skins, np.zeros_like(hidden)), fitter.reflectance(skins), atol=2e-6
    )


def test_the_minimum_is_that_of_scipy():
    """The same sum of squares from the same start, by another solver."""
    _, _, spectra, fitter = drawn(4, 2)
    noisy = spectra + np.random.default_rng(3).normal(0, 0.003, spectra.shape)
    found = fitter.fit(noisy)
    root = np.linalg.cholesky(E.precision).T
    centre = np.array([*E.centre, 0.0, 0.0])

    def residual(q, y):
        skin = from_coordinates(1 / (1 + np.exp(-q[None, :5])))
        wrong = (fitter.reflectance(skin, q[None, 5:])[0] - y) / E.noise
        return np.concatenate([wrong, root @ (q - centre)])

    for i in range(4):
        u = [
            p.to_coordinate(v)
            for p, v in zip(MEASURED2026B.parameters, found.values[i], strict=True)
        ]
        mine = np.array([*np.log(np.array(u) / (1 - np.array(u))), *found.scattering[i]])
        cost = (residual(mine, noisy[i]) ** 2).sum()
        other = least_squares(residual, mine + 0.2, args=(noisy[i],))
        assert cost <= 2 * other.cost * 1.01 + 1e-3


def test_values_that_are_held_stay():
    _, _, spectra, _ = drawn(5, 4)
    held = SpectralFitter(BANDS, MEASURED2026B, specular=RHO, held={"thickness": 80.0})
    found = held.fit(spectra)
    np.testing.assert_allclose(found.values[:, 2], 80.0)
    assert not found.covariance[:, 2].any()


def test_unmeasured_bands_and_too_few_of_them():
    _, _, spectra, fitter = drawn(3, 5)
    spectra[0, ::2] = np.nan
    spectra[1, 2:] = np.nan
    found = fitter.fit(spectra)
    assert np.isfinite(found.values[[0, 2]]).all()
    assert np.isnan(found.values[1]).all()
    assert np.isnan(found.rmse[1])
