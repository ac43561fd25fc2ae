"""Compiled surface of two parameters in RGB, and the point of it nearest to a colour.

The surface is a table of uniform cubic B-splines (m + 3, n + 3, 3) over cells x ∈ [0, m],
y ∈ [0, n] (see `kubelka_munk.py`), float64.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.least_squares_kernel import minimise, workspace
from cutis.kernels.spline_kernel import cell_of, cubic, cubic_curvatures, cubic_slopes, node_of

PIECE = 1024
"""Texels that a thread works on at a time."""
ITERATIONS = 60
"""Most Newton steps, refused ones included."""
CONVERGED = 1e-6
"""Step, in cells, that ends the search."""
ANY = 1e9
"""A step that is not limited."""


@compiled()
def _place(x: Any, cells: Any, w: Any) -> Any:
    """Fills w (3, 4) with weights at place x, their slopes and curvatures; the first node."""
    cell, f = cell_of(x, cells)
    w[0, 0], w[0, 1], w[0, 2], w[0, 3] = cubic(f)
    w[1, 0], w[1, 1], w[1, 2], w[1, 3] = cubic_slopes(f)
    w[2, 0], w[2, 1], w[2, 2], w[2, 3] = cubic_curvatures(f)
    return node_of(cell, int(cells))


@compiled()
def _evaluate(at: Any, problem: Any, a: Any, g: Any) -> Any:
    """½ |f − c|² at cells (2,), its slope g (2,) and its curvature a (2, 2).

    Where the cost is not convex, as far from the surface, a is only the part of it that is: JᵀJ.
    """
    table, colour, wx, wy = problem
    i = _place(at[0], table.shape[0] - 3.0, wx)
    j = _place(at[1], table.shape[1] - 3.0, wy)
    cost, gx, gy = 0.0, 0.0, 0.0
    hxx, hxy, hyy, jxx, jxy, jyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        f, fx, fy, fxx, fxy, fyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for p in range(4):
            s0, s1, s2 = 0.0, 0.0, 0.0
            for q in range(4):
                node = table[i + p, j + q, c]
                s0 += wy[0, q] * node
                s1 += wy[1, q] * node
                s2 += wy[2, q] * node
            f += wx[0, p] * s0
            fx += wx[1, p] * s0
            fxx += wx[2, p] * s0
            fy += wx[0, p] * s1
            fxy += wx[1, p] * s1
            fyy += wx[0, p] * s2
        r = f - colour[c]
        cost += 0.5 * r * r
        gx += r * fx
        gy += r * fy
        jxx += fx * fx
        jxy += fx * fy
        jyy += fy * fy
        hxx += r * fxx
        hxy += r * fxy
        hyy += r * fyy
    g[0], g[1] = gx, gy
    x, y, both = jxx + hxx, jyy + hyy, jxy + hxy
    if x <= 0.0 or y <= 0.0 or x * y - both * both <= 1e-12 * x * y:
        x, y, both = jxx, jyy, jxy
    a[0, 0], a[1, 1], a[0, 1], a[1, 0] = x, y, both, both
    return cost


@on_all_cores(PIECE)
def nearest_point_kernel(start: Any, stop: Any, colours: Any, table: Any, cells: Any) -> None:
    """Moves cells (n, 2) downhill to the point of the surface nearest to each colour (n, 3)."""
    search, rules = workspace(2), (ITERATIONS, ANY, 0.1, 10.0, 1e-3, CONVERGED, 0.0, 0.0)
    wx, wy = np.empty((3, 4)), np.empty((3, 4))
    low, high, held = np.empty(2), np.empty(2), np.empty(2, np.bool_)
    for p in range(2):
        low[p], high[p], held[p] = 0.0, table.shape[p] - 3.0, False
    for row in range(start, stop):
        problem = table, colours[row], wx, wy
        minimise(_evaluate, problem, cells[row], low, high, held, rules, search)


@on_all_cores(PIECE)
def surface_kernel(start: Any, stop: Any, cells: Any, table: Any, out: Any) -> None:
    """Fills out (n, 3) with the colours of the surface at cells (n, 2)."""
    wx, wy = np.empty((3, 4)), np.empty((3, 4))
    for row in range(start, stop):
        i = _place(cells[row, 0], table.shape[0] - 3.0, wx)
        j = _place(cells[row, 1], table.shape[1] - 3.0, wy)
        for c in range(3):
            total = 0.0
            for p in range(4):
                for q in range(4):
                    total += wx[0, p] * wy[0, q] * table[i + p, j + q, c]
            out[row, c] = total
