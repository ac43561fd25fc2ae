"""Skins from spectra: exact spectra come back, noise comes out as the covariance says."""

import csv

import numpy as np
import pytest
from scipy.stats import chi2

from cutis.albedo import albedo_space, halton
from cutis.albedo.sampled import SampledSpace
from cutis.errors import CutisError
from cutis.inverse import SpectralFitter, fit_spectra
from cutis.optics import (
    ALIAGA2022,
    GITLINA2020,
    MEASURED2026,
    NAMES,
    WAVELENGTHS,
    from_coordinates,
    to_coordinates,
)
from cutis.transport import two_layer_albedo

VISIBLE = np.arange(400.0, 701.0, 10.0)
USUAL = np.array(
    [
        [0.015, 0.02, 60.0, 0.4, 0.7],
        [0.03, 0.005, 90.0, 0.7, 0.5],
        [0.08, 0.03, 120.0, 0.8, 0.8],
        [0.15, 0.06, 70.0, 0.5, 0.3],
    ]
)


def solved(skins, wavelengths):
    """(n, w) albedo by the exact solver."""
    tissue = ALIAGA2022
    epidermis = [tissue.epidermis_absorption(x[0], x[3], wavelengths) for x in skins]
    dermis = [tissue.dermis_absorption(x[1], x[4], wavelengths) for x in skins]
    return np.array(
        [
            [
                two_layer_albedo(
                    [e], [d], [x[2]], float(s), float(g), dimension=2, count=24
                )[0, 0, 0]
                for e, d, s, g in zip(
                    es, ds, tissue.scattering(wavelengths), tissue.anisotropy(wavelengths),
                    strict=True,
                )
            ]
            for x, es, ds in zip(skins, epidermis, dermis, strict=True)
        ]
    )  # fmt: skip


@pytest.mark.parametrize(
    "wavelengths",
    [WAVELENGTHS, VISIBLE, np.array([415.0, 466, 503, 547, 565, 577, 592, 633, 688])],
    ids=["table", "visible", "nine"],
)
def test_spectra_of_the_exact_solver_give_their_skins(wavelengths):
    found = fit_spectra(solved(USUAL, wavelengths), wavelengths, ALIAGA2022)
    blended = len(wavelengths) == 9  # between the table's wavelengths: exact to 1e-4
    assert found.rmse.max() < (1e-4 if blended else 1e-5)
    np.testing.assert_allclose(
        to_coordinates(found.values), to_coordinates(USUAL), atol=0.04 if blended else 0.01
    )


def test_no_start_ends_in_another_valley():
    skins = halton(400, seed=5)
    spectra = SampledSpace(albedo_space(ALIAGA2022), VISIBLE).reflectance(skins)
    assert np.quantile(fit_spectra(spectra, VISIBLE, ALIAGA2022).rmse, [0.5, 1.0]) == pytest.approx(
        [0, 0], abs=1e-4
    )


def test_specular_part_is_taken_off():
    spectra = 0.028 + 0.972 * solved(USUAL, VISIBLE)
    found = fit_spectra(spectra, VISIBLE, ALIAGA2022, specular=0.028)
    np.testing.assert_allclose(to_coordinates(found.values), to_coordinates(USUAL), atol=0.01)
    assert fit_spectra(spectra, VISIBLE, ALIAGA2022).rmse.min() > 50 * found.rmse.max()


def test_rmse_is_that_of_the_reflectance_as_measured():
    spectra = 0.05 + 0.9 * solved(USUAL, VISIBLE)
    fitter = SpectralFitter(VISIBLE, ALIAGA2022, specular=0.03)
    found = fitter.fit(spectra)
    residual = fitter.reflectance(found.values) - spectra
    np.testing.assert_allclose(found.rmse, np.sqrt((residual**2).mean(axis=1)), rtol=1e-3)


def test_covariance_is_that_of_fits_to_noisy_spectra():
    """Level 1e-3 over all parameters, two-sided, fixed beforehand."""
    noise, draws = 3e-4, 600
    clean = solved(USUAL[:1], VISIBLE)
    rng = np.random.default_rng(11)
    found = fit_spectra(
        clean + noise * rng.standard_normal((draws, len(VISIBLE))), VISIBLE, ALIAGA2022, noise=noise
    )
    ratio = (draws - 1) * found.values.var(axis=0, ddof=1) / (found.sigma**2).mean(axis=0)
    low, high = chi2.ppf([1e-4, 1 - 1e-4], draws - 1)
    assert ((ratio > low) & (ratio < high)).all()
    seen = np.corrcoef(found.values.T)
    sigma = found.sigma[0]
    said = found.covariance[0] / np.outer(sigma, sigma)
    assert np.abs(np.arctanh(seen * 0.999999) - np.arctanh(said * 0.999999))[
        ~np.eye(5, dtype=bool)
    ].max() < 4.5 / np.sqrt(draws - 3)


def test_noise_is_estimated_from_the_residual():
    rng = np.random.default_rng(2)
    spectra = solved(USUAL[:1], VISIBLE) + 1e-3 * rng.standard_normal((300, len(VISIBLE)))
    estimated = fit_spectra(spectra, VISIBLE, ALIAGA2022).sigma
    known = fit_spectra(spectra, VISIBLE, ALIAGA2022, noise=1e-3).sigma
    np.testing.assert_allclose(np.median(estimated / known, axis=0), 1, atol=0.03)


def test_what_a_spectrum_does_not_tell_has_the_width_of_its_range():
    dark = solved(from_coordinates(np.array([[0.9, 0.5, 0.9, 0.5, 0.5]])), VISIBLE)
    found = fit_spectra(dark, VISIBLE, ALIAGA2022, noise=0.01)
    assert found.sigma[0, NAMES.index("oxygenation")] == pytest.approx(12**-0.5, rel=0.02)
    assert np.isfinite(found.covariance).all()


def test_held_parameters_stay_and_have_no_variance():
    spectra = solved(USUAL, VISIBLE)
    held = {"thickness": 80.0, "oxygenation": 0.6}
    found = fit_spectra(spectra, VISIBLE, ALIAGA2022, held=held)
    for name, value in held.items():
        i = NAMES.index(name)
        assert (found.values[:, i] == value).all()
        assert not found.covariance[:, i].any()
    free = fit_spectra(spectra, VISIBLE, ALIAGA2022)
    assert (found.rmse >= free.rmse - 1e-7).all()
    three = np.array([450.0, 550.0, 650.0])  # as many as there are free parameters
    few = fit_spectra(
        solved(USUAL[:1], three), three, ALIAGA2022, held={"thickness": 60.0, "oxygenation": 0.7}
    )
    assert np.isfinite(few.sigma).all()
    assert few.rmse.max() < 1e-4


def test_missing_values_do_not_count():
    spectra = solved(USUAL, VISIBLE)
    with_gaps = spectra.copy()
    with_gaps[:, ::3] = np.nan
    found = fit_spectra(with_gaps, VISIBLE, ALIAGA2022)
    np.testing.assert_allclose(to_coordinates(found.values), to_coordinates(USUAL), atol=0.02)
    with_gaps[1, 4:] = np.nan
    found = fit_spectra(with_gaps, VISIBLE, ALIAGA2022)
    assert np.isnan(found.rmse).tolist() == [False, True, False, False]
    assert np.isnan(found.values[1]).all()
    assert np.isfinite(found.values[[0, 2, 3]]).all()


def test_weights_move_the_fit_to_where_they_are():
    spectra = solved(USUAL[:1], VISIBLE) + 0.02 * (VISIBLE > 600)
    fitter = SpectralFitter(VISIBLE, ALIAGA2022)
    blue = fitter.fit(spectra, np.where(VISIBLE < 600, 1.0, 1e-4))
    residual = fitter.reflectance(blue.values) - spectra
    assert np.abs(residual[:, VISIBLE < 600]).max() < 2e-3 < np.abs(residual).max()


def test_other_tissues_have_their_own_parameters():
    skins = np.array([[0.03, 0.02, 0.5, 0.002]])
    spectra = albedo_space(GITLINA2020).reflectance(skins)
    found = fit_spectra(spectra, WAVELENGTHS, GITLINA2020)
    assert [p.name for p in found.parameters] == [
        "melanin", "blood", "eumelanin", "epidermal_blood",
    ]  # fmt: skip
    np.testing.assert_allclose(found.values, skins, rtol=0.02)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"specular": 0.5}, "specular"),
        ({"noise": 0.0}, "noise"),
        ({"held": {"melanine": 0.1}}, "not a free parameter"),
        ({"held": {"blood": 3.0}}, "outside its range"),
        ({"held": dict(zip(NAMES, USUAL[0], strict=True))}, "leave one free"),
        ({"wavelengths": VISIBLE[:4]}, "too few"),
        ({"wavelengths": [0.4, 0.5, 0.6]}, "380 to 780 nm"),
    ],
)
def test_what_cannot_be_fitted_is_said(change, words):
    arguments = {"wavelengths": VISIBLE, "tissue": ALIAGA2022, **change}
    with pytest.raises(CutisError, match=words):
        SpectralFitter(**arguments)


def test_wavelengths_that_are_too_short_are_set_right():
    spectra = solved(USUAL, VISIBLE + 2)
    found = fit_spectra(spectra, VISIBLE, ALIAGA2022, shift=2.0)
    assert found.rmse.max() < 1e-4
    assert fit_spectra(spectra, VISIBLE, ALIAGA2022).rmse.min() > 5 * found.rmse.max()
    ends = fit_spectra(np.full((1, 41), 0.3), WAVELENGTHS, ALIAGA2022, shift=2.0)
    assert np.isfinite(ends.values).all()
    with pytest.raises(CutisError, match="shift"):
        SpectralFitter(VISIBLE, ALIAGA2022, shift=11.0)


def test_spectra_of_another_length_are_refused():
    with pytest.raises(CutisError, match="not of shape"):
        SpectralFitter(VISIBLE, ALIAGA2022).fit(np.ones((3, 30)))


@pytest.mark.shared
def test_measured_skins_of_eight_groups(shared_data):
    """960 skins: the error known of this tissue, and no valley that 40 more starts find deeper."""
    path = shared_data / "spectra" / "measured" / "issa_half_a.csv"
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    rows = [row for row in rows if row["qc"] == "0"]
    groups = np.array([row["group"] for row in rows])
    spectra = np.array([[float(row[f"{lam:g}"]) for lam in VISIBLE] for row in rows])
    rng = np.random.default_rng(0)
    chosen = np.concatenate(
        [rng.choice(np.flatnonzero(groups == g), 120, replace=False) for g in np.unique(groups)]
    )
    fitter = SpectralFitter(VISIBLE, ALIAGA2022, specular=0.028)
    found = fitter.fit(spectra[chosen])
    assert found.rmse.mean() == pytest.approx(0.0087, abs=2e-4)

    class Everywhere(SpectralFitter):
        def starts(self, y, weight):
            more = np.random.default_rng(1).random((len(y), 40, 5))
            return np.concatenate([super().starts(y, weight), more], axis=1)

    calibrated = SpectralFitter(VISIBLE, MEASURED2026, specular=0.028)
    better = calibrated.fit(spectra[chosen])
    bias = (calibrated.reflectance(better.values) - spectra[chosen]).mean(axis=0)
    assert better.rmse.mean() < 0.0038
    assert np.abs(bias).max() < 0.003

    brute = Everywhere(VISIBLE, ALIAGA2022, specular=0.028).fit(spectra[chosen[::4]])
    deeper = found.rmse[::4] - brute.rmse
    assert np.mean(deeper > 1e-5) < 0.01
    assert deeper.max() < 5e-4
