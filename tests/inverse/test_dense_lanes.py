"""A block of a layer, as LLVM instructions, against NumPy."""

import numpy as np
from numba import njit

from cutis.inverse.dense_lanes import LANES, OUTPUTS, dense_block

RNG = np.random.default_rng(6)


@njit
def layer(weights, biases, block, count, source, first, out):
    dense_block(weights, biases, block, count, source, first, out)


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
