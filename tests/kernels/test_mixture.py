"""Mixtures of substances: compiled against plain, slopes against differences."""

import numpy as np
import pytest

from cutis.kernels import mixture
from cutis.kernels.mixture_kernel import absorb_in_band, absorb_in_bands, share_slopes, shares

RNG = np.random.default_rng(6)


@pytest.fixture(params=[(1, 1), (4, 5), (9, 8)], ids=str)
def table(request):
    """A recipe of some substances and parameters, and their spectra."""
    substances, parameters = request.param
    recipe = RNG.integers(0, 3, (substances, parameters))
    return recipe, RNG.uniform(0.1, 5.0, (1 + substances, 13)), RNG.random((37, parameters))


def test_absorption_of_many_skins_band_by_band(table):
    recipe, pure, skins = table
    expected = mixture.absorption(skins, recipe, pure)
    x, h = np.ascontiguousarray(skins.T, np.float32), np.empty((len(recipe), 37), np.float32)
    shares(x, recipe, h)
    np.testing.assert_allclose(h.T, mixture.shares(skins, recipe), rtol=1e-5)
    out = np.empty(37, np.float32)
    for band in range(13):
        absorb_in_band(h, pure.astype(np.float32), band, out)
        np.testing.assert_allclose(out, expected[:, band], rtol=3e-6)


def test_absorption_of_one_skin_in_all_bands(table):
    recipe, pure, skins = table
    h, out = np.empty((len(recipe), 1), np.float32), np.empty(13, np.float32)
    for skin in skins[:5]:
        shares(skin.astype(np.float32)[:, None], recipe, h)
        absorb_in_bands(h, pure.astype(np.float32), out)
        np.testing.assert_allclose(out, mixture.absorption(skin, recipe, pure), rtol=3e-6)


def test_slopes_of_shares_are_differences(table):
    """Shares are linear in each parameter, so that any step gives the slope."""
    recipe, _, skins = table
    found = np.empty(recipe.shape)
    for skin in skins[:5]:
        share_slopes(skin, recipe, found)
        for p in range(len(skin)):
            moved = skin + 0.5 * np.eye(len(skin))[p]
            rise = (mixture.shares(moved, recipe) - mixture.shares(skin, recipe)) / 0.5
            np.testing.assert_allclose(found[:, p], rise, atol=1e-6)


def test_by_hand():
    recipe = np.array([[mixture.TIMES, 0], [mixture.TIMES, mixture.WITHOUT]])
    skin = np.array([0.25, 0.4])
    np.testing.assert_allclose(mixture.shares(skin, recipe), [0.25, 0.25 * 0.6])
    pure = np.array([[1.0], [10.0], [100.0]])
    np.testing.assert_allclose(mixture.absorption(skin, recipe, pure), [1 + 2.5 + 15])
