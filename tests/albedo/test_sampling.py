"""Samplings of the albedo space."""

import numpy as np
import pytest
from scipy.stats import kstest, qmc

from cutis.albedo import halton, uniform
from cutis.optics import PARAMETERS, to_coordinates


@pytest.mark.parametrize("sampling", [halton, uniform])
def test_in_range_and_reproducible(sampling):
    skins = sampling(1000, seed=4)
    assert skins.shape == (1000, 5)
    assert skins.dtype == np.float64
    for i, p in enumerate(PARAMETERS):
        assert np.all((skins[:, i] >= p.low) & (skins[:, i] <= p.high))
    np.testing.assert_array_equal(skins, sampling(1000, seed=4))
    assert not np.array_equal(skins, sampling(1000, seed=5))
    assert sampling(0).shape == (0, 5)


@pytest.mark.parametrize("sampling", [halton, uniform])
def test_even_in_coordinates(sampling):
    u = to_coordinates(sampling(4000, seed=1))
    for axis in range(5):
        assert kstest(u[:, axis], "uniform").pvalue > 1e-3
    assert np.abs(np.corrcoef(u.T) - np.eye(5)).max() < 0.06


def test_halton_is_the_more_even():
    """Centred discrepancy of 1000 points a third or less of that of independent ones."""
    ours = qmc.discrepancy(np.clip(to_coordinates(halton(1000, seed=2)), 0, 1))
    independent = qmc.discrepancy(np.clip(to_coordinates(uniform(1000, seed=2)), 0, 1))
    assert ours < independent / 3


def test_halton_goes_on():
    """The first of many are the few: a longer sequence refines a shorter one."""
    np.testing.assert_array_equal(halton(2000, seed=3)[:500], halton(500, seed=3))
