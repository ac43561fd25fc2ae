"""Sizes of a face: means of 2 × 2 texels, against NumPy; the first is the face itself."""

import numpy as np
import pytest

from cutis.colour import encode_srgb
from cutis.maps import MapsFile
from cutis.optics import NAMES
from cutis.studio.drawing import codes
from cutis.studio.levels_kernel import halve
from cutis.textures import read_texture


def halved(values, weights):
    """The plain form of `halve`."""
    height, width = weights.shape
    out = np.zeros((-(-height // 2), -(-width // 2), values.shape[2]))
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            rows, columns = slice(2 * row, 2 * row + 2), slice(2 * column, 2 * column + 2)
            share = weights[rows, columns]
            if share.sum() > 0:
                total = (values[rows, columns] * share[..., None]).sum((0, 1))
                out[row, column] = total / share.sum()
    return out


@pytest.mark.parametrize("shape", [(6, 8), (7, 9), (1, 5), (2, 1)])
def test_halves_are_weighted_means(shape):
    random = np.random.default_rng(1)
    values = random.random((*shape, 3), np.float32)
    weights = (random.random(shape) > 0.4).astype(np.float32)
    out = np.full((-(-shape[0] // 2), -(-shape[1] // 2), 3), np.nan, np.float32)
    halve(len(out), values, weights, out)
    np.testing.assert_allclose(out, halved(values, weights), rtol=1e-6)


def test_codes_are_those_of_the_curve():
    random = np.random.default_rng(2)
    linear = random.uniform(-0.1, 1.1, (40, 50, 3)).astype(np.float32)
    linear[0, 0] = np.nan
    want = np.rint(255 * np.clip(encode_srgb(np.nan_to_num(linear)), 0, 1))
    assert np.abs(codes(linear).astype(int) - want).max() <= 1
    assert (codes(linear) == want).mean() > 0.99
    every = (np.arange(256) / 255).astype(np.float32)
    from cutis.colour import decode_srgb

    assert np.array_equal(codes(decode_srgb(every)[None, :, None].repeat(3, 2))[0, :, 0],
                          np.arange(256))  # fmt: skip


def test_the_first_level_is_the_face(workshop):
    levels = workshop.face.levels
    face = read_texture(workshop.face.capture)
    assert np.array_equal(levels.all[0].colours, face.linear())
    with MapsFile(workshop.face.maps) as file:
        skin = file.rows(slice(None))
    for i, name in enumerate(NAMES):
        assert np.array_equal(levels.all[0].maps[..., i], skin.maps[name])
    trust = levels.trusted(levels.all[0])
    assert np.array_equal(trust[..., 0], skin.sigmas["melanin"])
    assert np.array_equal(trust[..., -1], skin.confidence)


def test_levels_end_small_and_views_take_the_nearest(workshop):
    levels = workshop.face.levels
    assert [level.shape for level in levels.all] == [(200, 240), (100, 120), (50, 60), (25, 30)]
    numbers = [levels.at(scale).number for scale in (8, 1, 0.7, 0.5, 0.3, 0.25, 0.001)]
    assert numbers == [0, 0, 0, 1, 1, 2, 3]
