"""Compiled evaluation of a colour table (`colour_table.py`): skins → linear RGB.

Per texel 3 · 3 · 3 nodes of sixteen terms over melanin, eumelanin and thickness, and per channel
3 · 3 nodes over blood and oxygenation (`lanes.py`).
"""

from typing import Any

import numpy as np

from cutis.albedo.lanes import spline_product_16
from cutis.albedo.spline import first_node, place_in_cells, quadratic_weights
from cutis.kernels.compiling import compiled, on_all_cores

BLOCK = 128
"""Texels whose cells and weights are found together."""
PIECE = 128 * BLOCK
"""Texels that a thread works on at a time."""


@compiled(fast=True)
def _place(x: Any, low: Any, scale: Any, count: Any, at: Any) -> None:
    """Fills at (4, BLOCK) with cell and three weights of coordinates x (BLOCK,) on one axis."""
    cells = np.float32(count)
    for i in range(BLOCK):
        at[0, i], f = place_in_cells(x[i], low, scale, cells)
        at[1, i], at[2, i], at[3, i] = quadratic_weights(f)


@compiled(fast=True)
def _load(skins: Any, half: Any, x: Any) -> None:
    """Coordinates of skins (n, 5) into the rows of x (5, BLOCK), in the order of the axes."""
    for i in range(len(skins)):
        x[0, i], x[3, i], x[2, i] = skins[i, 0], skins[i, 1], skins[i, 2]
        x[1, i], x[4, i] = skins[i, 3], skins[i, 4]
    for i in range(BLOCK):
        x[0, i] = np.sqrt(np.sqrt(x[0, i]))
        x[3, i] = np.sqrt(np.sqrt(x[3, i]))
        x[2, i] = x[2, i] / (x[2, i] + half)


@on_all_cores(PIECE, fast=True)
def decode_kernel(
    start: Any, stop: Any, skins: Any, upper: Any, lower: Any, low: Any, scale: Any, half: Any,
    out: Any
) -> None:  # fmt: skip
    """Fills out (n, 3) with the RGB of skins (n, 5).

    `upper` (M+2, E+2, T+2, 16), `lower` (3, B+2, O+2, 16); `low`, `scale` tuples of five turn the
    coordinates of the axes into cells, `half` is the thickness halfway along its axis.
    """
    counts = (*upper.shape[:3], lower.shape[1], lower.shape[2])
    x = np.ones((5, BLOCK), dtype=np.float32)
    at = np.empty((20, BLOCK), dtype=np.float32)
    for first in range(start, stop, BLOCK):
        count = min(stop - first, BLOCK)
        _load(skins[first : first + count], half, x)
        for axis in range(5):
            place = at[4 * axis : 4 * axis + 4]
            _place(x[axis], low[axis], scale[axis], counts[axis] - 2, place)
        for i in range(count):
            above = (
                first_node(at[0, i], counts[0] - 2),
                first_node(at[4, i], counts[1] - 2),
                first_node(at[8, i], counts[2] - 2),
            )
            b, o = first_node(at[12, i], counts[3] - 2), first_node(at[16, i], counts[4] - 2)
            by_above = (
                (at[1, i], at[2, i], at[3, i]),
                (at[5, i], at[6, i], at[7, i]),
                (at[9, i], at[10, i], at[11, i]),
            )
            by_below = (at[13, i], at[14, i], at[15, i]), (at[17, i], at[18, i], at[19, i])
            # the sum over `upper` is the same in all three: compiled once
            red = spline_product_16(upper, above, by_above, lower, (0, b, o), by_below)
            green = spline_product_16(upper, above, by_above, lower, (1, b, o), by_below)
            blue = spline_product_16(upper, above, by_above, lower, (2, b, o), by_below)
            out[first + i, 0], out[first + i, 1], out[first + i, 2] = red, green, blue
