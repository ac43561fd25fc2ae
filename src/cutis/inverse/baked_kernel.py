"""Compiled look-up of the baked inverse: cubic B-splines over the chart of colours."""

from typing import Any

import numpy as np
from numba import njit, prange

from cutis.albedo.spline import cubic_weights, locate_cell

BLOCK = 1024
"""Texels that one task works on."""
DARK = np.float32(1e-6)
"""Keeps ratios of black texels finite."""


@njit(parallel=True, fastmath=True, cache=True)
def look_up(colours: Any, table: Any, low: Any, scale: Any, out: Any) -> None:
    """Fills out (n, 5) with coordinates in [0, 1] of colours (n, 3)."""
    n = colours.shape[0]
    for block in prange((n + BLOCK - 1) // BLOCK):
        for row in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            red = max(colours[row, 0], DARK)
            green = max(colours[row, 1], DARK)
            blue = max(colours[row, 2], DARK)
            i, fa = locate_cell(np.sqrt(np.sqrt(green)), low[0], scale[0], table.shape[0])
            j, fb = locate_cell(red / (red + green), low[1], scale[1], table.shape[1])
            k, fc = locate_cell(blue / (blue + green), low[2], scale[2], table.shape[2])
            wa, wb, wc = cubic_weights(fa), cubic_weights(fb), cubic_weights(fc)
            s0, s1, s2, s3, s4 = (
                np.float32(0),
                np.float32(0),
                np.float32(0),
                np.float32(0),
                np.float32(0),
            )
            for p in range(4):
                for q in range(4):
                    wpq = wa[p] * wb[q]
                    for r in range(4):
                        w = wpq * wc[r]
                        node = table[i + p, j + q, k + r]
                        s0 += w * node[0]
                        s1 += w * node[1]
                        s2 += w * node[2]
                        s3 += w * node[3]
                        s4 += w * node[4]
            out[row, 0] = min(max(s0, np.float32(0)), np.float32(1))
            out[row, 1] = min(max(s1, np.float32(0)), np.float32(1))
            out[row, 2] = min(max(s2, np.float32(0)), np.float32(1))
            out[row, 3] = min(max(s3, np.float32(0)), np.float32(1))
            out[row, 4] = min(max(s4, np.float32(0)), np.float32(1))
