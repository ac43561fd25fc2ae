"""Compiled spectra and colours of many skins at the wavelengths of the table.

The mixture and the table are those of `slopes_kernel.py`. A block of skins goes through one band
after the other: absorptions and spline weights of all its skins at once, then one product of two
spline sums for each. What is read of the table for one band, 17 KB, stays in the nearest cache.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.mixture_kernel import absorb_in_band, shares
from cutis.kernels.spline_kernel import node_of, place_cubic

BLOCK = 128
"""Skins that go through the bands together."""
PIECE = 32 * BLOCK
"""Skins that a thread works on at a time."""
THICKNESS = 2
"""Its place among parameters."""
ZERO, ONE = np.float32(0), np.float32(1)


@compiled(fast=True)
def _load(
    skins: Any, recipe: Any, low: Any, scale: Any, cells: Any, x: Any, h: Any, at: Any
) -> None:
    """Skins (n, p) into x (p, BLOCK); their shares into h (c, BLOCK), thickness into at."""
    for p in range(x.shape[0]):
        for i in range(len(skins)):
            x[p, i] = skins[i, p]
        for i in range(len(skins), BLOCK):
            x[p, i] = ONE
    shares(x, recipe, h)
    for i in range(BLOCK):
        x[0, i] = np.log(x[THICKNESS, i])
    place_cubic(x[0], low[0, 2], scale[0, 2], cells, at)


@compiled(fast=True)
def _place(h: Any, pure: Any, b: Any, low: Any, scale: Any, cells: Any, x: Any, at: Any) -> None:
    """Absorption of a layer in band b, as cells and weights at (5, BLOCK)."""
    absorb_in_band(h, pure, b, x)
    for i in range(BLOCK):
        x[i] = np.sqrt(np.sqrt(x[i]))
    place_cubic(x, low, scale, cells, at)


@compiled(fast=True, inline=True)
def _albedo(upper: Any, lower: Any, i: Any, e_at: Any, d_at: Any, t_at: Any) -> Any:
    """Σ_r upper_r(e, t) · lower_r(d) of skin i; tables of one band."""
    e = node_of(e_at[0, i], upper.shape[0] - 3)
    k = node_of(t_at[0, i], upper.shape[1] - 3)
    d = node_of(d_at[0, i], lower.shape[0] - 3)
    r0, r1, r2, r3 = upper[e], upper[e + 1], upper[e + 2], upper[e + 3]
    total = np.float32(0)
    for r in range(8):  # compilers make vectors of this loop, not of the one inside
        a, c = np.float32(0), np.float32(0)
        for q in range(4):
            a += t_at[1 + q, i] * (
                e_at[1, i] * r0[k + q, r]
                + e_at[2, i] * r1[k + q, r]
                + e_at[3, i] * r2[k + q, r]
                + e_at[4, i] * r3[k + q, r]
            )
            c += d_at[1 + q, i] * lower[d + q, r]
        total += a * c
    return total


@on_all_cores(PIECE, fast=True)
def reflectance_kernel(
    start: Any, stop: Any, skins: Any, recipe: Any, above: Any, below: Any, upper: Any, lower: Any,
    low: Any, scale: Any, weights: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, bands) with reflectance, or (n, 3) with its sums over `weights` (bands, 3).

    Reflectance is what is wanted where `weights` have no rows.
    """
    x = np.empty((skins.shape[1], BLOCK), np.float32)
    h = np.empty((recipe.shape[0], BLOCK), np.float32)
    at = np.empty((3, 5, BLOCK), np.float32)
    root, sums = np.empty(BLOCK, np.float32), np.empty((3, BLOCK), np.float32)
    e_at, d_at, t_at = at[0], at[1], at[2]
    first, summed = above.shape[0] - 1, len(weights) > 0
    spectra = np.empty((BLOCK, 1), np.float32) if summed else out
    for begin in range(start, stop, BLOCK):
        count = min(stop - begin, BLOCK)
        _load(skins[begin : begin + count], recipe, low, scale, upper.shape[2] - 3, x, h, t_at)
        for b in range(upper.shape[0]):
            _place(h, above, b, low[b, 0], scale[b, 0], upper.shape[1] - 3, root, e_at)
            _place(h[first:], below, b, low[b, 1], scale[b, 1], lower.shape[1] - 3, root, d_at)
            row, column = (0, 0) if summed else (begin, b)
            for i in range(count):
                spectra[row + i, column] = _albedo(upper[b], lower[b], i, e_at, d_at, t_at)
            if summed:
                for c in range(3):
                    weight = weights[b, c]
                    for i in range(count):
                        sums[c, i] = spectra[i, 0] * weight + (sums[c, i] if b > 0 else ZERO)
        if summed:
            for c in range(3):
                for i in range(count):
                    out[begin + i, c] = sums[c, i]
