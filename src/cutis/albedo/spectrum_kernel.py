"""Compiled evaluation of the separated table (`separated.py`): skins → reflectance or RGB.

Parameters and `spectra` are those of `spline.py`. A block of texels goes through one wavelength
after the other: absorptions and spline weights of all its texels at once, then one product of two
spline sums for each (`lanes.py`). What is read of the table for one wavelength, 17 KB, stays in the
nearest cache.
"""

from typing import Any

import numpy as np

from cutis.albedo.lanes import spline_product_8
from cutis.albedo.spline import cubic_weights, first_node, locate_cell, place_in_cells
from cutis.kernels.compiling import compiled, on_all_cores

BLOCK = 128
"""Texels that go through the bands together."""
PIECE = 32 * BLOCK
"""Texels that a thread works on at a time."""
ONE = np.float32(1)


@compiled(fast=True)
def _locate(
    x: Any, slots: Any, spectra: Any, b: Any, cells: Any, low: Any, scale: Any, at: Any
) -> None:
    """Fills at (10, BLOCK) with epidermis cell and weights, dermis cell and weights at band b."""
    eumelanin, pheomelanin, bare = spectra[0, b], spectra[1, b], spectra[2, b]
    deoxygenated, oxygenated, baseline = spectra[3, b], spectra[4, b], spectra[5, b]
    low_e, scale_e, low_d, scale_d = low[b, 0], scale[b, 0], low[b, 1], scale[b, 1]
    cells_e, cells_d = np.float32(cells[0]), np.float32(cells[1])
    for i in range(BLOCK):
        pigment = x[3, i] * eumelanin + (ONE - x[3, i]) * pheomelanin
        blood = x[4, i] * oxygenated + (ONE - x[4, i]) * deoxygenated
        if len(slots) == 8:
            blood += x[7, i] * (spectra[9, b] - blood)
        epidermis = x[0, i] * pigment + (ONE - x[0, i]) * bare
        dermis = x[1, i] * blood + (ONE - x[1, i]) * baseline
        if len(slots) == 6:
            epidermis += x[5, i] * (blood - bare)
        if len(slots) == 8:
            epidermis += x[6, i] * spectra[7, b]
            dermis += x[5, i] * spectra[6, b] + x[6, i] * spectra[8, b]
        at[0, i], f = place_in_cells(np.sqrt(np.sqrt(epidermis)), low_e, scale_e, cells_e)
        at[1, i], at[2, i], at[3, i], at[4, i] = cubic_weights(f)
        at[5, i], f = place_in_cells(np.sqrt(np.sqrt(dermis)), low_d, scale_d, cells_d)
        at[6, i], at[7, i], at[8, i], at[9, i] = cubic_weights(f)


@compiled(fast=True)
def _load(skins: Any, slots: Any, thickness: Any, x: Any, at: Any) -> None:
    """Parameters (n, p) into the rows of x (8, BLOCK); thickness cell and weights into at."""
    low, scale, count = thickness
    for i in range(len(skins)):
        for p in range(len(slots)):
            x[p, i] = skins[i, p]
        k, f = locate_cell(np.log(x[2, i]), low, scale, count)
        at[0, i] = np.float32(k)
        at[1, i], at[2, i], at[3, i], at[4, i] = cubic_weights(f)


@compiled(fast=True, inline=True)
def _albedo(b: Any, i: Any, at: Any, at_t: Any, upper: Any, lower: Any) -> Any:
    e = first_node(at[0, i], upper.shape[1] - 3)
    d = first_node(at[5, i], lower.shape[1] - 3)
    k = first_node(at_t[0, i], upper.shape[2] - 3)
    by_e = (at[1, i], at[2, i], at[3, i], at[4, i])
    by_t = (at_t[1, i], at_t[2, i], at_t[3, i], at_t[4, i])
    by_d = (at[6, i], at[7, i], at[8, i], at[9, i])
    return spline_product_8(upper, (b, e, k), (by_e, by_t), lower, (b, d), (by_d,))


@on_all_cores(PIECE, fast=True)
def reflectance_kernel(
    start: Any, stop: Any, skins: Any, slots: Any, spectra: Any, upper: Any, lower: Any, low: Any,
    scale: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, bands) with reflectance in [0, 1]."""
    cells = upper.shape[1] - 3, lower.shape[1] - 3
    thickness = low[0, 2], scale[0, 2], upper.shape[2]
    x = np.ones((8, BLOCK), dtype=np.float32)
    at = np.empty((10, BLOCK), dtype=np.float32)
    at_t = np.empty((5, BLOCK), dtype=np.float32)
    for first in range(start, stop, BLOCK):
        part = skins[first : min(stop, first + BLOCK)]
        _load(part, slots, thickness, x, at_t)
        for b in range(spectra.shape[1]):
            _locate(x, slots, spectra, b, cells, low, scale, at)
            for i in range(len(part)):
                out[first + i, b] = _albedo(b, i, at, at_t, upper, lower)


@on_all_cores(PIECE, fast=True)
def rgb_kernel(
    start: Any, stop: Any, skins: Any, slots: Any, spectra: Any, upper: Any, lower: Any, low: Any,
    scale: Any, to_rgb: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, 3) with Σ_band albedo · to_rgb (bands, 3)."""
    cells = upper.shape[1] - 3, lower.shape[1] - 3
    thickness = low[0, 2], scale[0, 2], upper.shape[2]
    x = np.ones((8, BLOCK), dtype=np.float32)
    at = np.empty((10, BLOCK), dtype=np.float32)
    at_t = np.empty((5, BLOCK), dtype=np.float32)
    for first in range(start, stop, BLOCK):
        part = skins[first : min(stop, first + BLOCK)]
        _load(part, slots, thickness, x, at_t)
        rgb = out[first : first + len(part)]
        for i in range(len(part)):
            rgb[i, 0] = rgb[i, 1] = rgb[i, 2] = 0
        for b in range(spectra.shape[1]):
            _locate(x, slots, spectra, b, cells, low, scale, at)
            red, green, blue = to_rgb[b, 0], to_rgb[b, 1], to_rgb[b, 2]
            for i in range(len(part)):
                albedo = _albedo(b, i, at, at_t, upper, lower)
                rgb[i, 0] += albedo * red
                rgb[i, 1] += albedo * green
                rgb[i, 2] += albedo * blue
