"""Compiled look-up of the baked inverse: cubic B-splines over the chart of colours.

A block of texels at a time: first cells and weights of all, then the sum over 4 · 4 · 4 nodes of
eight lanes for each (`kernels/lanes.py`), then ranges and powers of all.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.lanes import sum_around
from cutis.kernels.spline_kernel import node_of, place_cubic
from cutis.kernels.warp_kernel import value_of

BLOCK = 128
"""Texels whose cells and weights are found together."""
PIECE = 128 * BLOCK
"""Texels that a thread works on at a time."""
DARK = np.float32(1e-6)
"""Keeps ratios of black texels finite."""
ZERO, ONE = np.float32(0), np.float32(1)


@compiled(fast=True)
def _load(colours: Any, x: Any) -> None:
    """Chart coordinates a, b, c of colours (n, 3) into the rows of x (3, BLOCK)."""
    for p in range(3):
        for i in range(len(colours)):
            x[p, i] = colours[i, p]
        for i in range(len(colours), BLOCK):
            x[p, i] = ONE
    for i in range(BLOCK):
        red, green, blue = max(x[0, i], DARK), max(x[1, i], DARK), max(x[2, i], DARK)
        x[0, i] = np.sqrt(np.sqrt(green))
        x[1, i] = red / (red + green)
        x[2, i] = blue / (blue + green)


@compiled(fast=True)
def _store(u: Any, axes: Any, form: Any, out: Any) -> None:
    """u (n, 8) into out (n, m) by `form`; see `look_up`."""
    for p in range(out.shape[1]):
        if form == 1:
            for i in range(out.shape[0]):
                out[i, p] = value_of(u[i, p], axes, p)
        elif form == 0:
            for i in range(out.shape[0]):
                out[i, p] = min(max(u[i, p], ZERO), ONE)
        else:
            for i in range(out.shape[0]):
                out[i, p] = u[i, p]


@on_all_cores(PIECE, fast=True)
def look_up(
    start: Any, stop: Any, colours: Any, table: Any, low: Any, scale: Any, axes: Any, form: Any,
    out: Any
) -> None:  # fmt: skip
    """Fills out (n, 5) with the skins of colours (n, 3), or (n, m) with what the table holds.

    `table` (a, b, c, 8) has coordinates in its first five lanes; `low`, `scale` (3,) turn a, b, c
    into cells. By `form`, coordinates are written clamped to [0, 1] (0), as units by `axes` (1,
    see `kernels/warp.py`), or m lanes as they are (2).
    """
    cells = (table.shape[0] - 3, table.shape[1] - 3, table.shape[2] - 3)
    x = np.empty((3, BLOCK), dtype=np.float32)
    at = np.empty((3, 5, BLOCK), dtype=np.float32)
    u = np.empty((BLOCK, 8), dtype=np.float32)
    for first in range(start, stop, BLOCK):
        count = min(stop - first, BLOCK)
        _load(colours[first : first + count], x)
        for axis in range(3):
            place_cubic(x[axis], low[axis], scale[axis], cells[axis], at[axis])
        for i in range(count):
            cell = (
                node_of(at[0, 0, i], cells[0]),
                node_of(at[1, 0, i], cells[1]),
                node_of(at[2, 0, i], cells[2]),
            )
            weights = (
                (at[0, 1, i], at[0, 2, i], at[0, 3, i], at[0, 4, i]),
                (at[1, 1, i], at[1, 2, i], at[1, 3, i], at[1, 4, i]),
                (at[2, 1, i], at[2, 2, i], at[2, 3, i], at[2, 4, i]),
            )
            sum_around(table, cell, weights, u, i)
        _store(u, axes, form, out[first : first + count])
