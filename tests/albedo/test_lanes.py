"""Sums over lanes, as LLVM instructions, against NumPy."""

import numpy as np
from numba import njit

from cutis.albedo.lanes import spline_lanes_8, spline_product_8, spline_product_16

RNG = np.random.default_rng(5)


@njit
def write(table, cell, by_a, by_b, by_c, out, row):
    spline_lanes_8(table, cell, (by_a, by_b, by_c), out, row)


@njit
def product_8(first, cell, by_a, by_b, second, place, by_c):
    return spline_product_8(first, cell, (by_a, by_b), second, place, (by_c,))


@njit
def product_16(first, cell, by_a, by_b, second, place, by_c):
    return spline_product_16(first, cell, (by_a, by_b), second, place, (by_c,))


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


def test_product_of_two_sums_with_a_leading_axis():
    for lanes, function in ((8, product_8), (16, product_16)):
        first = RNG.standard_normal((5, 9, 6, lanes)).astype(np.float32)
        second = RNG.standard_normal((4, 8, lanes)).astype(np.float32)
        a, b, c = weights(4), weights(4), weights(4)
        got = function(first, (4, 5, 2), a, b, second, (3, 4), c)
        left = np.einsum("p,q,pql->l", a, b, first[4, 5:9, 2:6])
        right = np.einsum("p,pl->l", c, second[3, 4:8])
        np.testing.assert_allclose(got, left @ right, rtol=1e-4)
