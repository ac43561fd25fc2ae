"""Fits of measured spectra: recovered where they come from the model, honest where they do not."""

import csv

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.inverse.spectra import fit_spectra, spectral_space
from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates, to_coordinates
from cutis.transport import two_layer_albedo

VISIBLE = WAVELENGTHS[2:33]  # 400 to 700 nm
RNG = np.random.default_rng(11)
COORDINATES = RNG.uniform([0.1, 0.15, 0.1, 0.2, 0.2], [0.7, 0.6, 0.9, 0.9, 0.9], (200, 5))


@pytest.fixture(scope="module")
def skins():
    return from_coordinates(COORDINATES)


def test_spectra_of_the_model_are_recovered(skins):
    found = fit_spectra(albedo_space().reflectance(skins)[:, 2:33], VISIBLE)
    assert found.rmse.max() < 2e-4
    off = np.abs(to_coordinates(found.parameters) - COORDINATES)
    assert np.median(off, axis=0).max() < 0.01
    # what is far off is where a spectrum says little, and sigma says so
    z = np.abs(found.parameters - skins) / found.sigma
    assert (z < 3).mean() > 0.99


def test_the_specular_part_is_undone(skins):
    albedo = albedo_space().reflectance(skins[:20])[:, 2:33]
    plain = fit_spectra(albedo, VISIBLE)
    included = fit_spectra(0.03 + 0.97 * albedo, VISIBLE, specular=0.03)
    np.testing.assert_allclose(included.parameters, plain.parameters, rtol=2e-2, atol=1e-3)
    np.testing.assert_allclose(included.model, 0.03 + 0.97 * plain.model, atol=1e-4)


def test_other_wavelengths_are_solved_not_interpolated():
    """Haemoglobin's bands at 542 and 577 nm lie between the nodes of every 10 nm."""
    at = np.array([455.0, 542.0, 560.0, 577.0, 610.0, 655.0])
    skin = np.array([0.03, 0.02, 80.0, 0.7, 0.75])
    found = spectral_space(ALIAGA2022, at).reflectance(skin)
    tissue = ALIAGA2022
    exact = [
        two_layer_albedo(
            tissue.epidermis_absorption(skin[0], skin[3], wavelength),
            tissue.dermis_absorption(skin[1], skin[4], wavelength),
            skin[2], float(tissue.scattering(wavelength)), float(tissue.anisotropy(wavelength)),
        ).item()
        for wavelength in at
    ]  # fmt: skip
    np.testing.assert_allclose(found, exact, atol=2e-5)
    fit = fit_spectra(found[None], at)
    assert fit.rmse[0] < 1e-4


def test_noise_is_covered_by_sigma(skins):
    """Of white noise, nine in ten 90 % intervals hold the truth where the data decide."""
    albedo = albedo_space().reflectance(skins)[:, 2:33]
    noisy = albedo + RNG.normal(0, 0.003, albedo.shape)
    found = fit_spectra(noisy, VISIBLE)
    z = (found.parameters - skins)[:, :2] / found.sigma[:, :2]
    assert 0.8 < (np.abs(z) < 1.645).mean() < 0.97
    assert 0.0022 < np.median(found.rmse) < 0.0034


def test_no_start_finds_a_better_minimum(skins, monkeypatch):
    """Fifteen more starts leave the cost of three as it is."""
    import cutis.inverse.spectra as module

    albedo = albedo_space().reflectance(skins[:60])[:, 2:33]
    bent = albedo * (1 + 0.04 * np.sin(VISIBLE / 40))  # not of the model
    few = fit_spectra(bent, VISIBLE).rmse
    monkeypatch.setattr(module, "STARTS", np.random.default_rng(2).uniform(0.1, 0.9, (18, 5)))
    many = fit_spectra(bent, VISIBLE).rmse
    assert (few < many + 2e-5).mean() > 0.98


def test_spectra_with_holes_are_left_out(skins):
    albedo = albedo_space().reflectance(skins[:3])[:, 2:33].astype(float)
    albedo[1, 4] = np.nan
    found = fit_spectra(albedo, VISIBLE)
    assert np.isnan(found.parameters[1]).all()
    assert np.isfinite(found.parameters[[0, 2]]).all()
    assert np.isnan(found.rmse[1])


@pytest.mark.shared
def test_measured_skin(shared_data):
    """`aliaga2022`: 0.0089 in the mean over eight groups, too dark at 620 and too bright at 700."""
    file = (shared_data / "spectra" / "measured" / "issa_half_a.csv").open()
    with file:
        table = list(csv.DictReader(line for line in file if not line.startswith("#")))
    rows = [row for row in table if row["qc"] == "0"][::8]
    measured = np.array([[float(row[f"{v:g}"] or "nan") for v in VISIBLE] for row in rows])
    found = fit_spectra(measured, VISIBLE, specular=0.028)
    good = np.isfinite(found.rmse)
    groups = np.array([row["group"] for row in rows])
    means = [found.rmse[good & (groups == group)].mean() for group in np.unique(groups)]
    assert 0.0080 < np.mean(means) < 0.0095
    bias = (found.model - measured)[good].mean(axis=0)
    assert bias[VISIBLE == 620] < -0.007
    assert bias[VISIBLE == 700] > 0.015


@pytest.mark.parametrize(
    ("spectra", "at", "what"),
    [
        (np.full((1, 31), 40.0), VISIBLE, "per cent"),
        (np.full((1, 31), -0.2), VISIBLE, "negative"),
        (np.full((1, 31), 0.4), VISIBLE / 1000, "µm"),
        (np.full((1, 31), 0.4), VISIBLE[::-1], "larger than the last"),
        (np.full((1, 31), 0.4), VISIBLE + 200, "reach beyond"),
        (np.full((1, 4), 0.4), VISIBLE[:4], "too few"),
        (np.full((1, 30), 0.4), VISIBLE, "must be"),
        (np.full((1, 31), 0.4), np.where(VISIBLE == 500, np.nan, VISIBLE), "finite"),
    ],
)
def test_what_is_no_spectrum_is_refused(spectra, at, what):
    with pytest.raises(CutisError, match=what):
        fit_spectra(spectra, at)


def test_a_specular_share_out_of_range_is_refused():
    with pytest.raises(CutisError, match="specular"):
        fit_spectra(np.full((1, 31), 0.4), VISIBLE, specular=2.8)
