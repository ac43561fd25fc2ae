"""Blotches and freckles: as many and as large as they say, and the same however they are asked."""

import numpy as np
import pytest
from scipy.ndimage import label, uniform_filter

from cutis.looks import BlotchesPart, FrecklesPart, PatchesPart
from cutis.looks.folder import Folder
from cutis.maps import Maps, Tile
from cutis.maps.patches import patches
from cutis.maps.plain import Place
from cutis.optics import NAMES

SHAPE = (384, 512)
PARTS = {
    "freckles": FrecklesPart(size=0.006),
    "even": FrecklesPart(size=0.004, clustered=0, soft=0),
    "blotches": BlotchesPart(),
    "small": BlotchesPart(size=0.03, soft=0.3),
    "patches": PatchesPart(),
}


class AnyFace:
    def __init__(self, shape, number):
        self.shape, self.number = shape, number


def drawn(part, shape=SHAPE, rows=slice(None), number=1001):
    start, stop, _ = rows.indices(shape[0])
    zero = np.zeros((stop - start, shape[1]), np.float32)
    maps = Maps(dict.fromkeys(NAMES, zero), zero + 1, Place(start, shape))
    return part.on_face(AnyFace(shape, number), Folder())(Tile(maps))


@pytest.mark.parametrize("name", PARTS)
def test_the_same_in_bands_other_with_another_seed_or_tile(name):
    part = PARTS[name]
    whole = drawn(part)
    assert whole.min() == 0
    assert 0.4 < whole.max() <= 1
    for rows in (slice(0, 1), slice(37, 111), slice(380, 384)):
        np.testing.assert_array_equal(drawn(part, rows=rows), whole[rows])
    other = drawn(part.model_copy(update={"seed": 2}))
    assert abs(np.corrcoef(other.ravel(), whole.ravel())[0, 1]) < 0.3
    assert abs(np.corrcoef(drawn(part, number=1002).ravel(), whole.ravel())[0, 1]) < 0.3


@pytest.mark.parametrize("name", PARTS)
def test_twice_the_size_shows_the_same(name):
    large = drawn(PARTS[name], (SHAPE[0] * 2, SHAPE[1] * 2))
    large = large.reshape(SHAPE[0], 2, SHAPE[1], 2).mean((1, 3))
    small = drawn(PARTS[name])
    assert np.corrcoef(large.ravel(), small.ravel())[0, 1] > 0.97
    np.testing.assert_allclose(large.mean(), small.mean(), rtol=0.05)


@pytest.mark.parametrize("density", [0.1, 0.4])
def test_even_freckles_cover_their_density(density):
    part = FrecklesPart(size=0.008, density=density, clustered=0, soft=0)
    found = [drawn(part.model_copy(update={"seed": seed})) > 0.15 for seed in range(8)]
    # a spot covers pi r^2 (1 + (a^2 + b^2) / 2): 1 % more than a circle; edges add some
    assert np.mean(found) == pytest.approx(density, rel=0.12)


def test_sizes_are_spread_about_the_median():
    part = FrecklesPart(size=0.01, density=0.02, clustered=0, soft=0)
    covers = [drawn(part.model_copy(update={"seed": seed})) > 0.15 for seed in range(6)]
    areas = np.concatenate([np.bincount(label(one)[0].ravel())[1:] for one in covers])
    radii = np.sqrt(areas / np.pi) / SHAPE[1]
    assert np.median(radii) == pytest.approx(0.01, rel=0.1)
    assert 0.25 < np.std(np.log(radii)) < 0.55


def test_clusters_leave_skin_between_them():
    def dispersion(clustered):
        part = FrecklesPart(size=0.004, density=0.2, clustered=clustered)
        found = [drawn(part.model_copy(update={"seed": seed})) for seed in range(4)]
        return np.mean([np.std(uniform_filter(one, 64)) / one.mean() for one in found])

    assert dispersion(1) > 2.5 * dispersion(0)
    assert dispersion(1) > dispersion(0.5) > dispersion(0)


@pytest.mark.parametrize(("size", "density"), [(0.05, 0.2), (0.2, 0.5)])
def test_blotches_cover_their_density(size, density):
    found = drawn(BlotchesPart(size=size, density=density, soft=0.1))
    assert found.mean() == pytest.approx(density, abs=0.03)


def test_smaller_blotches_are_more():
    def count(size):
        return label(drawn(BlotchesPart(size=size, soft=0.1)) > 0.5)[1]

    assert count(0.02) > 4 * count(0.08)


def test_patches_are_as_they_were():
    """Those of vitiligo, by values of the first version of them."""
    found = patches((64, 96))
    assert found.mean() == pytest.approx(0.350925, abs=1e-5)
    np.testing.assert_array_equal(found, drawn(PatchesPart(), (64, 96)))
