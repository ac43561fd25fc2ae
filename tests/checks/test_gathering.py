"""One pass does not depend on how rows come."""

import numpy as np

from cutis.checks.gathering import SIDE, Gathering, Stored
from cutis.colour import SRGB
from cutis.textures import Texture


def gathered(pixels, mask, heights):
    found = Gathering(pixels.shape[:2], Stored("uint8", SRGB, "given"), True)
    whole, first = Texture(pixels, ("R", "G", "B"), SRGB), 0
    for height in heights:
        rows = slice(first, first + height)
        part = whole.rows(rows)
        found.add(first, part, part.linear(), mask[rows])
        first += height
    return found.finish()


def test_bands_make_no_difference():
    rng = np.random.default_rng(0)
    pixels = rng.integers(0, 256, (1300, 900, 3), dtype=np.uint8)
    mask = (rng.random((1300, 900)) > 0.02).astype(np.float32)
    mask[:100] = 0
    one, many = gathered(pixels, mask, [1300]), gathered(pixels, mask, [1, 7, 250, 1000, 42])
    assert one.picture.shape[0] <= SIDE
    for name in ("picture", "cover", "texels", "values", "places", "sure"):
        np.testing.assert_allclose(getattr(one, name), getattr(many, name), atol=1e-6)
    assert one.tallies == many.tallies
    assert [w[:2] for w in one.windows] == [w[:2] for w in many.windows] != []
    for (_, _, a), (_, _, b) in zip(one.windows, many.windows, strict=True):
        np.testing.assert_array_equal(a, b)
    for (a, c), (b, d) in zip(one.edges, many.edges, strict=True):
        np.testing.assert_array_equal(a, b)
        np.testing.assert_array_equal(c, d)


def test_means_are_those_of_the_mask():
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[:, :2] = 255
    mask = np.zeros((4, 4), np.float32)
    mask[:, :2] = 1
    found = gathered(pixels, mask, [4])
    assert found.tallies.inside == 8
    assert found.tallies.top == 8
    np.testing.assert_allclose(found.picture[:, :2], 1)
    np.testing.assert_array_equal(found.cover, mask)


def test_any_size():
    for shape in ((1, 1), (1, 5000), (5000, 1), (3, 385), (770, 769)):
        found = gathered(np.full((*shape, 3), 7, np.uint8), np.ones(shape, np.float32), [shape[0]])
        assert found.sure.all()
        assert found.picture.shape[:2] == found.cover.shape
        assert len(found.places) == found.cover.size
        np.testing.assert_array_equal(found.places.max(axis=0) + 1, found.cover.shape)
