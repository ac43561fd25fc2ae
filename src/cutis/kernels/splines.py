"""Uniform B-splines in plain NumPy and SciPy: what they are and how they are made.

A spline over [0, 1] or over cells 0 to n has one coefficient more than cells for each degree, since
the B-splines of the end cells reach beyond the ends. Kernels evaluate with `spline_kernel.py`.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def basis(x: Array, cells: int, degree: int = 3) -> Array:
    """(len(x), cells + degree) values of the B-splines of [0, 1] at x; the end's beyond it."""
    from scipy.interpolate import BSpline

    inside = np.clip(x, 0.0, 1.0)
    knots = _knots(cells, degree) / cells
    return np.asarray(BSpline.design_matrix(inside, knots, degree, extrapolate=True).toarray())


def through_nodes(values: NDArray[np.floating], axes: int, ends: str) -> Array:
    """Coefficients of the cubic spline through values at the nodes of the first `axes` axes.

    `ends` as SciPy names them: "natural" (no curvature there) or "not-a-knot" (one cubic over the
    two end cells). There are two coefficients more than nodes along each axis.
    """
    coefficients = np.asarray(values, dtype=np.float64)
    for axis in range(axes):
        coefficients = along(from_nodes(coefficients.shape[axis], ends), coefficients, axis)
    return np.ascontiguousarray(coefficients)


def from_nodes(count: int, ends: str) -> Array:
    """(count + 2, count) matrix from values at nodes to coefficients; see `through_nodes`."""
    from scipy.interpolate import make_interp_spline

    nodes = np.arange(count, dtype=np.float64)
    spline = make_interp_spline(nodes, np.eye(count), bc_type=ends)
    # two points more, inside the end cells, say which of the splines on even knots it is
    places = np.sort(np.append(nodes, [0.5, count - 1.5]))
    return np.asarray(make_interp_spline(places, spline(places), t=_knots(count - 1, 3)).c)


def from_chebyshev(count: int, cells: int, degree: int = 3) -> Array:
    """(cells + degree, count) least-squares matrix from values at `chebyshev(count)` to splines."""
    from scipy.interpolate import make_lsq_spline

    polynomials = np.polynomial.chebyshev.chebvander
    x = np.linspace(0.0, 1.0, 8 * cells + 1)
    back = np.linalg.inv(polynomials(2 * chebyshev(count) - 1, count - 1))
    values = polynomials(2 * x - 1, count - 1) @ back
    knots = _knots(cells, degree) / cells
    return np.asarray(make_lsq_spline(x, values, knots, degree).c)


def along(matrix: Array, values: NDArray[np.floating], axis: int) -> Array:
    """Values with a matrix applied along one axis."""
    return np.moveaxis(np.tensordot(matrix, values, axes=(1, axis)), 0, axis)


def chebyshev(count: int) -> Array:
    """(count,) Chebyshev points of [0, 1], ends included."""
    return (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2


def _knots(cells: int, degree: int) -> Array:
    return np.arange(-degree, cells + degree + 1, dtype=np.float64)
