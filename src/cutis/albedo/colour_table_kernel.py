"""Compiled evaluation of a colour table (`colour_table.py`): skins → linear RGB.

Per texel 3 · 3 · 3 nodes of sixteen terms over melanin, eumelanin and thickness, and per channel
3 · 3 nodes over blood and oxygenation.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.spline_kernel import node_of, place_quadratic

BLOCK = 128
"""Texels whose cells and weights are found together."""
PIECE = 128 * BLOCK
"""Texels that a thread works on at a time."""
ONE = np.float32(1)


@compiled(fast=True)
def _load(skins: Any, half: Any, x: Any) -> None:
    """Coordinates of skins (n, 5) into the rows of x (5, BLOCK), in the order of the axes."""
    for i in range(len(skins)):
        x[0, i], x[3, i], x[2, i] = skins[i, 0], skins[i, 1], skins[i, 2]
        x[1, i], x[4, i] = skins[i, 3], skins[i, 4]
    for p in range(5):
        for i in range(len(skins), BLOCK):
            x[p, i] = ONE
    for i in range(BLOCK):
        x[0, i] = np.sqrt(np.sqrt(x[0, i]))
        x[3, i] = np.sqrt(np.sqrt(x[3, i]))
        x[2, i] = x[2, i] / (x[2, i] + half)


@compiled(fast=True, inline=True)
def _colour(upper: Any, lower: Any, i: Any, at: Any, rgb: Any) -> None:
    """Fills rgb (3,) with Σ_r upper_r · lower_cr of texel i, at (5, 4, BLOCK)."""
    m = node_of(at[0, 0, i], upper.shape[0] - 2)
    e = node_of(at[1, 0, i], upper.shape[1] - 2)
    t = node_of(at[2, 0, i], upper.shape[2] - 2)
    b = node_of(at[3, 0, i], lower.shape[1] - 2)
    o = node_of(at[4, 0, i], lower.shape[2] - 2)
    red, green, blue = np.float32(0), np.float32(0), np.float32(0)
    for r in range(16):  # compilers make vectors of this loop, not of those inside
        above = np.float32(0)
        for p in range(3):
            r0, r1, r2 = upper[m + p, e], upper[m + p, e + 1], upper[m + p, e + 2]
            line = np.float32(0)
            for q in range(3):
                line += at[2, 1 + q, i] * (
                    at[1, 1, i] * r0[t + q, r]
                    + at[1, 2, i] * r1[t + q, r]
                    + at[1, 3, i] * r2[t + q, r]
                )
            above += at[0, 1 + p, i] * line
        x, y, z = np.float32(0), np.float32(0), np.float32(0)
        for p in range(3):
            for q in range(3):
                weight = at[3, 1 + p, i] * at[4, 1 + q, i]
                x += weight * lower[0, b + p, o + q, r]
                y += weight * lower[1, b + p, o + q, r]
                z += weight * lower[2, b + p, o + q, r]
        red += above * x
        green += above * y
        blue += above * z
    rgb[0], rgb[1], rgb[2] = red, green, blue


@on_all_cores(PIECE, fast=True)
def decode_kernel(
    start: Any, stop: Any, skins: Any, upper: Any, lower: Any, low: Any, scale: Any, half: Any,
    out: Any
) -> None:  # fmt: skip
    """Fills out (n, 3) with the RGB of skins (n, 5).

    `upper` (M+2, E+2, T+2, 16), `lower` (3, B+2, O+2, 16); `low`, `scale` (5,) turn the coordinates
    of the axes into cells, `half` is the thickness halfway along its axis.
    """
    x = np.empty((5, BLOCK), dtype=np.float32)
    at = np.empty((5, 4, BLOCK), dtype=np.float32)
    for first in range(start, stop, BLOCK):
        count = min(stop - first, BLOCK)
        _load(skins[first : first + count], half, x)
        for axis in range(5):
            cells = upper.shape[axis] if axis < 3 else lower.shape[axis - 2]
            place_quadratic(x[axis], low[axis], scale[axis], cells - 2, at[axis])
        for i in range(count):
            _colour(upper, lower, i, at, out[first + i])
