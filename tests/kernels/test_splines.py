"""Splines as SciPy has them, and the compiled weights against those."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from cutis.kernels import splines
from cutis.kernels.compiling import compiled
from cutis.kernels.spline_kernel import (
    cell_of,
    cubic,
    cubic_curvatures,
    cubic_slopes,
    node_of,
    place_cubic,
    place_quadratic,
)

RNG = np.random.default_rng(4)


@compiled()
def weigh(f, out):
    for i in range(len(f)):
        out[0, i, 0], out[0, i, 1], out[0, i, 2], out[0, i, 3] = cubic(f[i])
        out[1, i, 0], out[1, i, 1], out[1, i, 2], out[1, i, 3] = cubic_slopes(f[i])
        out[2, i, 0], out[2, i, 1], out[2, i, 2], out[2, i, 3] = cubic_curvatures(f[i])


@compiled(fast=True)
def nodes(x, cells, out):
    for i in range(len(x)):
        out[i] = node_of(cell_of(x[i], np.float32(cells))[0], cells)


def matrix(place, x, cells, degree):
    """(len(x), cells + degree) values of the B-splines, from a kernel's cells and weights."""
    at = np.empty((degree + 2, len(x)), np.float32)
    place(x.astype(np.float32), np.float32(0.25), np.float32(2.0), cells, at)
    found = np.zeros((len(x), cells + degree))
    for k in range(degree + 1):
        found[np.arange(len(x)), at[0].astype(int) + k] = at[1 + k]
    return found


@pytest.mark.parametrize(("place", "degree"), [(place_cubic, 3), (place_quadratic, 2)])
def test_cells_and_weights_are_those_of_the_basis(place, degree):
    cells = 7
    x = np.concatenate([RNG.uniform(0, 4, 300), [0.25, 3.75, -9, 99]])
    expected = splines.basis((x - 0.25) * 2 / cells, cells, degree)
    np.testing.assert_allclose(matrix(place, x, cells, degree), expected, atol=3e-6)


def test_slopes_and_curvatures_are_differences():
    f, step = RNG.uniform(0.01, 0.99, 50), 1e-5
    found = np.empty((2, 3, 50, 4))
    weigh(f, found[0])
    weigh(f + step, found[1])
    for order in (0, 1):
        rise = (found[1, order] - found[0, order]) / step
        np.testing.assert_allclose(rise, found[0, order + 1], atol=3e-5)
    np.testing.assert_allclose(found[0].sum(axis=-1), [[1] * 50, [0] * 50, [0] * 50], atol=1e-6)


def test_no_number_leaves_the_table():
    out = np.empty(6, int)
    nodes(np.array([-5, 0, 6.9, 7, 1e30, np.nan], np.float32), 7, out)
    np.testing.assert_array_equal(out[:5], [0, 0, 6, 6, 6])
    assert 0 <= out[5] < 7


@pytest.mark.parametrize("ends", ["natural", "not-a-knot"])
def test_splines_through_nodes(ends):
    """Against SciPy's own cubic splines, along two axes one after the other."""
    values = RNG.standard_normal((9, 6, 2))
    found = splines.through_nodes(values, 2, ends)
    assert found.shape == (11, 8, 2)
    x, y = RNG.random(40) * 8, RNG.random(30) * 5
    bases = splines.basis(x / 8, 8), splines.basis(y / 5, 5)
    along = CubicSpline(np.arange(9), values, axis=0, bc_type=ends)(x)
    expected = CubicSpline(np.arange(6), along, axis=1, bc_type=ends)(y)
    np.testing.assert_allclose(np.einsum("xa,yb,abc->xyc", *bases, found), expected, atol=1e-12)


@pytest.mark.parametrize(("count", "cells", "degree"), [(18, 24, 3), (10, 8, 2)])
def test_splines_of_chebyshev_values(count, cells, degree):
    """Of a smooth function and of one that splines of this degree hold exactly."""
    nodes, x = splines.chebyshev(count), np.linspace(0, 1, 101)
    made = splines.from_chebyshev(count, cells, degree)
    for function, error in ((lambda v: np.exp(v) + v**degree, 1e-4), (lambda v: v**degree, 1e-12)):
        found = splines.basis(x, cells, degree) @ made @ function(nodes)
        np.testing.assert_allclose(found, function(x), atol=error)
    assert nodes[0] == 0
    assert nodes[-1] == pytest.approx(1)
