"""Compiled look-up of the baked inverse: cubic B-splines over the chart of colours.

A block of texels at a time: first cells and weights of all, then the sum over 4 · 4 · 4 nodes of
eight lanes for each (`albedo/lanes.py`), then ranges and powers of all.
"""

from typing import Any

import numpy as np

from cutis.albedo.lanes import spline_lanes_8
from cutis.albedo.spline import cubic_weights, first_node, place_in_cells
from cutis.inverse.units_kernel import store_units
from cutis.kernels.compiling import compiled, on_all_cores

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
    for i in range(len(colours)):
        x[0, i], x[1, i], x[2, i] = colours[i, 0], colours[i, 1], colours[i, 2]
    for i in range(BLOCK):
        red, green, blue = max(x[0, i], DARK), max(x[1, i], DARK), max(x[2, i], DARK)
        x[0, i] = np.sqrt(np.sqrt(green))
        x[1, i] = red / (red + green)
        x[2, i] = blue / (blue + green)


@compiled(fast=True)
def _place(x: Any, low: Any, scale: Any, count: Any, at: Any) -> None:
    """Fills at (5, BLOCK) with cell and four weights of coordinates x (BLOCK,) on one axis."""
    cells = np.float32(count)
    for i in range(BLOCK):
        at[0, i], f = place_in_cells(x[i], low, scale, cells)
        at[1, i], at[2, i], at[3, i], at[4, i] = cubic_weights(f)


@compiled(fast=True)
def _store_coordinates(u: Any, out: Any) -> None:
    for i in range(len(out)):
        for p in range(5):
            out[i, p] = min(max(u[i, p], ZERO), ONE)


@on_all_cores(PIECE, fast=True)
def look_up(
    begin: Any,
    stop: Any,
    colours: Any,
    table: Any,
    low: Any,
    scale: Any,
    ranges: Any,
    form: Any,
    out: Any,
) -> None:
    """Fills out (n, 5) with the skins of colours (n, 3), or (n, m) with what the table holds.

    `table` (a, b, c, 8) has coordinates in its first five lanes; `low`, `scale` (3,) turn a, b, c
    into cells. By `form`, coordinates are written clamped to [0, 1] (0), as units by `ranges` (1,
    see `units_kernel.py`), or m lanes as they are (2).
    """
    cells = (table.shape[0] - 3, table.shape[1] - 3, table.shape[2] - 3)
    x = np.ones((3, BLOCK), dtype=np.float32)
    at = np.empty((15, BLOCK), dtype=np.float32)
    u = np.empty((BLOCK, 8), dtype=np.float32)
    for start in range(begin, stop, BLOCK):
        end = min(stop, start + BLOCK)
        _load(colours[start:end], x)
        for axis in range(3):
            _place(x[axis], low[axis], scale[axis], cells[axis], at[5 * axis : 5 * axis + 5])
        for i in range(end - start):
            cell = (
                first_node(at[0, i], cells[0]),
                first_node(at[5, i], cells[1]),
                first_node(at[10, i], cells[2]),
            )
            weights = (
                (at[1, i], at[2, i], at[3, i], at[4, i]),
                (at[6, i], at[7, i], at[8, i], at[9, i]),
                (at[11, i], at[12, i], at[13, i], at[14, i]),
            )
            spline_lanes_8(table, cell, weights, u, i)
        if form == 1:
            store_units(u, ranges, out[start:end])
        elif form == 0:
            _store_coordinates(u, out[start:end])
        else:
            for i in range(end - start):
                for p in range(out.shape[1]):
                    out[start + i, p] = u[i, p]
