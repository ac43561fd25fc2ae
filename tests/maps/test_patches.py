"""Procedural patches: as much as they say, the same every time and at every size."""

import numpy as np
import pytest

from cutis.maps.patches import COVERAGE, patches


@pytest.mark.parametrize("shape", [(200, 200), (120, 200), (300, 90), (41, 57)])
def test_they_cover_a_third(shape):
    weights = patches(shape)
    assert weights.shape == shape
    assert weights.dtype == np.float32
    assert weights.min() == 0
    assert weights.max() == 1
    assert weights.mean() == pytest.approx(COVERAGE, abs=0.02)


def test_same_seed_same_patches():
    np.testing.assert_array_equal(patches((60, 80)), patches((60, 80)))
    assert np.abs(patches((60, 80), seed=8) - patches((60, 80))).mean() > 0.2


def test_same_patches_at_twice_the_size():
    large = patches((240, 320)).reshape(120, 2, 160, 2).mean(axis=(1, 3))
    small = patches((120, 160))
    assert np.abs(large - small).mean() < 0.02
    assert np.abs(large - small).max() < 0.5


def test_edges_are_soft_and_few():
    weights = patches((300, 300))
    partial = np.mean((weights > 0) & (weights < 1))
    assert 0.005 < partial < 0.15


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (2, 2)])
def test_tiny_images(shape):
    assert np.isfinite(patches(shape)).all()
