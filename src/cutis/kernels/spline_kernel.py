"""Uniform B-splines, compiled; what they are is in `splines.py`.

A place x is in cells, 0 to their number; beyond the ends, and where it is no number, it is taken to
an end. `at` holds the place of many x as rows: first their cells, as whole numbers, then the
weights of the nodes around, then, where they are wanted, the derivatives of these weights by x.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled

ONE, TWO, THREE, SIX = np.float32(1), np.float32(2), np.float32(3), np.float32(6)
ZERO, HALF = np.float32(0), np.float32(0.5)


@compiled(fast=True, inline=True)
def cubic(f: Any) -> Any:
    """Weights of the four cubic B-splines at fraction f of a cell."""
    g = ONE - f
    return (
        g * g * g / SIX,
        (TWO * TWO - THREE * f * f * (TWO - f)) / SIX,
        (TWO * TWO - THREE * g * g * (TWO - g)) / SIX,
        f * f * f / SIX,
    )


@compiled(fast=True, inline=True)
def cubic_slopes(f: Any) -> Any:
    """Derivatives of `cubic` by f."""
    g = ONE - f
    return (
        -HALF * g * g,
        HALF * f * (THREE * f - TWO * TWO),
        -HALF * g * (THREE * g - TWO * TWO),
        HALF * f * f,
    )


@compiled(fast=True, inline=True)
def cubic_curvatures(f: Any) -> Any:
    """Second derivatives of `cubic` by f."""
    g = ONE - f
    return g, THREE * f - TWO, THREE * g - TWO, f


@compiled(fast=True, inline=True)
def quadratic(f: Any) -> Any:
    """Weights of the three quadratic B-splines at fraction f of a cell."""
    g = ONE - f
    return HALF * g * g, HALF + f * g, HALF * f * f


@compiled(fast=True, inline=True)
def cell_of(x: Any, cells: Any) -> Any:
    """The cell that x is in, as a whole number of its type, and the fraction of the way through.

    In a form that compilers run on many x at once; `cells` is a number of the type of x.
    """
    inside = min(max(x, ZERO), cells)
    cell = np.floor(min(inside, cells - HALF))
    return cell, inside - cell


@compiled(fast=True, inline=True)
def node_of(cell: Any, cells: Any) -> Any:
    """A cell of `cell_of` as an index, inside the table even when x was no number."""
    return min(max(int(cell), 0), cells - 1)


@compiled(fast=True)
def place_cubic(x: Any, low: Any, scale: Any, cells: Any, at: Any) -> None:
    """Fills at (5, n) with cells and weights of (x − low) · scale, x (n,)."""
    most = np.float32(cells)
    for i in range(at.shape[1]):
        at[0, i], f = cell_of((x[i] - low) * scale, most)
        at[1, i], at[2, i], at[3, i], at[4, i] = cubic(f)


@compiled(fast=True)
def place_quadratic(x: Any, low: Any, scale: Any, cells: Any, at: Any) -> None:
    """Fills at (4, n) with cells and weights of (x − low) · scale, x (n,)."""
    most = np.float32(cells)
    for i in range(at.shape[1]):
        at[0, i], f = cell_of((x[i] - low) * scale, most)
        at[1, i], at[2, i], at[3, i] = quadratic(f)
