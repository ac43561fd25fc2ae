"""Learning a prior: from skins that are made up, so that the truth is known."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.albedo.sampled import SampledSpace
from cutis.inverse.fit import logistic
from cutis.inverse.prior import SkinPrior
from cutis.optics import MEASURED2026, from_coordinates, to_coordinates
from studies.prior_training import (
    MeasuredSkins,
    even_weights,
    regression_quantiles,
    train_prior,
)

LAM = np.arange(400.0, 701.0, 10.0)
RHO = 0.028
NOISE = 0.004


def population(count: int, seed: int) -> tuple[MeasuredSkins, np.ndarray]:
    """Skins whose logits are normal, tone and type of melanin going together; their parameters."""
    rng = np.random.default_rng(seed)
    z = np.array([-0.7, -1.3, -0.8, -0.4, 0.8]) + rng.standard_normal((count, 5)) * 0.4
    z[:, 0] += 0.5 * rng.standard_normal(count)
    z[:, 3] -= 0.6 * (z[:, 0] + 0.7)
    parameters = from_coordinates(logistic(z).astype(float))
    albedo = SampledSpace(albedo_space(MEASURED2026), LAM).reflectance(parameters)
    spectra = RHO + (1 - RHO) * albedo + NOISE * rng.standard_normal(albedo.shape)
    subjects = np.array([f"{i // 2}" for i in range(count)])
    return MeasuredSkins(spectra, LAM, subjects, RHO), parameters


@pytest.fixture(scope="module")
def trained() -> SkinPrior:
    return train_prior(population(400, 0)[0], MEASURED2026)


def implied(prior: SkinPrior, skins: MeasuredSkins) -> np.ndarray:
    """(n,) RMS of the spectra that colours imply."""
    space = albedo_space(MEASURED2026)
    u = prior.skins(space, skins.albedo)
    albedo = SampledSpace(space, LAM).reflectance(from_coordinates(u.astype(float)))
    return np.sqrt(((RHO + (1 - RHO) * albedo - skins.spectra) ** 2).mean(axis=1))


def test_new_skins_lie_in_their_intervals(trained):
    """90 % of them, by a Z-test; fitted parameters, as in training."""
    from cutis.inverse import SpectralFitter

    skins, _ = population(400, 1)
    fitted = SpectralFitter(LAM, MEASURED2026, specular=RHO).fit(skins.spectra).values
    space = albedo_space(MEASURED2026)
    u = trained.skins(space, skins.albedo).astype(float)
    sigma, _ = trained.trust(space, skins.albedo, u)
    away = np.abs(to_coordinates(fitted) - u)
    for i in range(5):
        inside = away[:, i] <= 1.645 * sigma[:, i]
        # of 400, and of the 400 that the width was learned from
        spread = np.sqrt(0.9 * 0.1 * (1 / 400 + 1 / 400))
        assert abs(inside.mean() - 0.9) < 4 * spread


def test_the_means_are_where_spectra_are_nearest(trained):
    """Other means imply spectra that are farther off: the slopes of training are right."""
    skins, _ = population(400, 0)
    weights = even_weights(skins.bands)
    best = weights @ implied(trained, skins)
    rng = np.random.default_rng(2)
    for _ in range(6):
        step = 0.1 * rng.standard_normal(trained.means.shape)
        moved = replace(trained, means=trained.means + step)
        assert weights @ implied(moved, skins) > best


def test_a_colour_tells_nearly_what_noise_leaves(trained):
    skins, _ = population(300, 3)
    assert np.median(implied(trained, skins)) < 2.5 * NOISE


def test_less_freedom_is_steadier():
    skins, _ = population(200, 4)
    free, held = (
        train_prior(skins, MEASURED2026, freedom=freedom)
        for freedom in (np.ones(5), (1, 1, 1, 0.1, 1))
    )
    space = albedo_space(MEASURED2026)
    spread = [prior.skins(space, skins.albedo)[:, 3].std() for prior in (free, held)]
    assert spread[1] < 0.5 * spread[0]


def test_quantiles_leave_their_share_below():
    rng = np.random.default_rng(5)
    terms = np.stack([np.ones(2000), rng.uniform(-1, 1, 2000)], axis=1)
    values = np.exp(0.5 + 1.2 * terms[:, 1] + (0.3 + 0.2 * terms[:, 1]) * rng.standard_normal(2000))
    found = regression_quantiles(terms, values[:, None], np.ones(2000), 0.9)
    below = values <= np.exp(terms @ found[:, 0])
    assert below.mean() == pytest.approx(0.9, abs=2 / 2000)  # exact, but for points on the line
    # log-normal: quantile 0.5 + 1.2 x + 1.2816 (0.3 + 0.2 x)
    np.testing.assert_allclose(found[:, 0], [0.884, 1.456], atol=0.06)


def test_weights_are_even_over_bands():
    bands = np.array([0, 0, 0, 2, 2, 5])
    weights = even_weights(bands)
    assert weights.sum() == pytest.approx(1)
    np.testing.assert_allclose([weights[bands == k].sum() for k in (0, 2, 5)], 1 / 3)
