"""Sums written out as vectors, against NumPy."""

import numpy as np

from cutis.kernels.compiling import compiled
from cutis.kernels.lanes import LANES, OUTPUTS, dense_block, sum_around

RNG = np.random.default_rng(5)


@compiled()
def write(table, cell, by_a, by_b, by_c, out, row):
    sum_around(table, cell, (by_a, by_b, by_c), out, row)


@compiled()
def layer(weights, biases, block, count, source, first, out):
    dense_block(weights, biases, block, count, source, first, out)


def weights(count):
    return tuple(RNG.random(count, dtype=np.float32))


def test_sum_over_three_axes_fills_one_row():
    table = RNG.standard_normal((7, 6, 9, 8)).astype(np.float32)
    out = np.full((3, 8), 7, dtype=np.float32)
    a, b, c = weights(4), weights(4), weights(4)
    write(table, (3, 1, 5), a, b, c, out, 1)
    expected = np.einsum("p,q,r,pqrl->l", a, b, c, table[3:7, 1:5, 5:9])
    np.testing.assert_allclose(out[1], expected, rtol=1e-5, atol=1e-5)
    np.testing.assert_array_equal(out[[0, 2]], 7)


def test_weights_may_be_of_any_number():
    table = RNG.standard_normal((5, 4, 3, 8)).astype(np.float32)
    out = np.zeros((1, 8), dtype=np.float32)
    a, b, c = weights(2), weights(3), weights(1)
    write(table, (1, 0, 2), a, b, c, out, 0)
    expected = np.einsum("p,q,r,pqrl->l", a, b, c, table[1:3, :3, 2:3])
    np.testing.assert_allclose(out[0], expected, rtol=1e-5, atol=1e-5)


def test_one_block_of_outputs_and_texels():
    weights = RNG.standard_normal((3, 9, OUTPUTS)).astype(np.float32)
    biases = RNG.standard_normal(3 * OUTPUTS).astype(np.float32)
    source = RNG.standard_normal((12, 4 * LANES)).astype(np.float32)
    out = np.full((3 * OUTPUTS, 4 * LANES), 5, dtype=np.float32)
    layer(weights, biases, 1, 8, source, 2 * LANES, out)
    rows, columns = slice(OUTPUTS, 2 * OUTPUTS), slice(2 * LANES, 3 * LANES)
    expected = biases[rows, None] + weights[1, :8].T @ source[:8, columns]
    np.testing.assert_allclose(out[rows, columns], expected, rtol=1e-5, atol=1e-5)
    out[rows, columns] = 5
    assert np.all(out == 5)
