"""Rare chromophores from spectra."""

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.inverse import SpectralFitter, fit_spectra
from cutis.optics import ALIAGA2022, MEASURED2026, NAMES, TISSUES, with_rare_chromophores

VISIBLE = np.arange(400.0, 701.0, 10.0)
NOISE = 1e-3


def drawn(tissue, count=150, seed=0):
    """(count, 8) usual skins with bilirubin and methaemoglobin, and their noisy spectra."""
    rng = np.random.default_rng(seed)
    low = [0.01, 0.01, 50, 0.3, 0.3, 0, 0, 0]
    high = [0.08, 0.05, 120, 0.9, 0.9, 0.06, 0, 0.4]
    skins = rng.uniform(low, high, (count, 8))
    spectra = albedo_space(with_rare_chromophores(tissue)).reflectance(skins)[:, 2:33]
    return skins, spectra + rng.normal(0, NOISE, spectra.shape)


@pytest.mark.parametrize("tissue", TISSUES.values(), ids=TISSUES)
def test_there_and_back_within_sigma(tissue):
    """90 % intervals hold the truth in 90 % of the skins, to the noise of 150 of them."""
    skins, spectra = drawn(tissue)
    found = fit_spectra(spectra, VISIBLE, tissue, free=("methaemoglobin", "bilirubin"), noise=NOISE)
    assert [p.name for p in found.parameters] == [*NAMES, "bilirubin", "methaemoglobin"]
    truth = skins[:, [5, 7]]
    inside = np.abs(found.values[:, 5:] - truth) < 1.645 * found.sigma[:, 5:]
    assert np.all(inside.mean(axis=0) > 0.82)
    # scattering that follows melanin type leaves bilirubin less sharp
    known = [0.005 if tissue.dermis_by_type else 0.003, 0.01]
    assert np.all(np.median(found.sigma[:, 5:], axis=0) < known)
    assert found.covariance.shape == (150, 7, 7)


def test_those_not_asked_for_are_none_and_not_told():
    _, spectra = drawn(MEASURED2026, 5)
    plain = fit_spectra(spectra, VISIBLE, MEASURED2026)
    assert [p.name for p in plain.parameters] == list(NAMES)
    fitter = SpectralFitter(VISIBLE, MEASURED2026, held={"bilirubin": 0.03}, free=["carotene"])
    found = fitter.fit(spectra)
    assert [p.name for p in found.parameters] == [*NAMES, "bilirubin", "carotene"]
    assert np.all(found.values[:, 5] == 0.03)
    assert np.all(found.sigma[:, 5] == 0)
    residual = fitter.reflectance(found.values) - spectra
    np.testing.assert_allclose(np.sqrt((residual**2).mean(axis=1)), found.rmse, atol=1e-5)


def test_a_tissue_that_has_them_tells_all():
    skins, spectra = drawn(MEASURED2026, 3)
    held = {"carotene": 0.0}
    found = fit_spectra(spectra, VISIBLE, with_rare_chromophores(MEASURED2026), held=held)
    assert found.values.shape == (3, 8)
    np.testing.assert_allclose(found.values[:, 7], skins[:, 7], atol=0.05)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"free": ["melanin"]}, "melanin cannot be freed"),
        ({"free": ["water"]}, "water cannot be freed"),
        ({"free": ["bilirubin"], "held": {"bilirubin": 0.1}}, "both free and held at 0.1"),
        ({"held": {"bilirubin": 0.3}}, "outside its range"),
        (
            {"free": ["bilirubin", "carotene"], "wavelengths": VISIBLE[:6]},
            "6 wavelengths are too few for 7 free parameters",
        ),
    ],
)
def test_what_cannot_be(arguments, message):
    with pytest.raises(CutisError, match=message):
        SpectralFitter(**{"wavelengths": VISIBLE, "tissue": ALIAGA2022, **arguments})
