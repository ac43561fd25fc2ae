"""Compiled spectra at any wavelengths, with exact slopes: parameters → albedo and ∂albedo.

Parameters, `slots` and `spectra` are those of `spline.py`, but `spectra` holds absorptions
at n wavelengths of the caller's. Wavelength i lies `blends[i]` of the way from band `bands[i]` of
the table to the next; what is blended is transport, which is smooth, not absorption.
"""

from typing import Any

import numpy as np

from cutis.albedo.spline import (
    cubic_weights,
    locate_cell,
    mixtures,
    parameter_slopes,
    weight_slopes,
)
from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 64
"""Skins that a thread works on at a time."""
ONE, QUARTER = np.float32(1), np.float32(0.25)


@compiled(fast=True, inline=True)
def _sums(c: Any, i: Any, j: Any, k: Any, we: Any, wd: Any, wt: Any, se: Any, sd: Any, st: Any
) -> Any:  # fmt: skip
    """Sum of the 4 × 4 × 4 coefficients at cell (i, j, k), and its slopes by e, d and t."""
    value, by_e, by_d, by_t = np.float32(0), np.float32(0), np.float32(0), np.float32(0)
    for p in range(4):
        line, line_d, line_t = np.float32(0), np.float32(0), np.float32(0)
        for q in range(4):
            r = c[i + p, j + q]
            here = wt[0] * r[k] + wt[1] * r[k + 1] + wt[2] * r[k + 2] + wt[3] * r[k + 3]
            rise = st[0] * r[k] + st[1] * r[k + 1] + st[2] * r[k + 2] + st[3] * r[k + 3]
            line += wd[q] * here
            line_d += sd[q] * here
            line_t += wd[q] * rise
        value += we[p] * line
        by_e += se[p] * line
        by_d += we[p] * line_d
        by_t += we[p] * line_t
    return value, by_e, by_d, by_t


@compiled(fast=True, inline=True)
def _band(
    b: Any, re: Any, rd: Any, k: Any, wt: Any, st: Any, table: Any, low: Any, scale: Any
) -> Any:
    """Albedo in band b and its slopes by μa_e^¼, μa_d^¼ and log t.

    Goes on straight where the absorption at a wavelength nearby is beyond those of the band.
    """
    i, fe = locate_cell(re, low[b, 0], scale[b, 0], table.shape[1])
    j, fd = locate_cell(rd, low[b, 1], scale[b, 1], table.shape[2])
    value, by_e, by_d, by_t = _sums(
        table[b],
        i,
        j,
        k,
        cubic_weights(fe),
        cubic_weights(fd),
        wt,
        weight_slopes(fe),
        weight_slopes(fd),
        st,
    )
    by_e, by_d = by_e * scale[b, 0], by_d * scale[b, 1]
    high_e = low[b, 0] + np.float32(table.shape[1] - 3) / scale[b, 0]
    high_d = low[b, 1] + np.float32(table.shape[2] - 3) / scale[b, 1]
    value += by_e * (re - min(max(re, low[b, 0]), high_e))
    value += by_d * (rd - min(max(rd, low[b, 1]), high_d))
    return value, by_e, by_d, by_t * scale[b, 2]


@compiled(fast=True)
def spectrum_and_slope(
    x: Any, slots: Any, spectra: Any, bands: Any, blends: Any, table: Any, low: Any, scale: Any,
    spectrum: Any, slope: Any
) -> None:  # fmt: skip
    """Fills spectrum (n,) and slope (n, p) = ∂albedo/∂parameter of one skin x (p,)."""
    k, ft = locate_cell(np.log(x[2]), low[0, 2], scale[0, 2], table.shape[3])
    wt, st = cubic_weights(ft), weight_slopes(ft)
    for n in range(len(bands)):
        b, f = bands[n], blends[n]
        pigment, blood, epidermis, dermis = mixtures(x, slots, spectra, n)
        re, rd = np.sqrt(np.sqrt(epidermis)), np.sqrt(np.sqrt(dermis))
        value, by_e, by_d, by_t = _band(b, re, rd, k, wt, st, table, low, scale)
        if f > 0:
            above = _band(b + 1, re, rd, k, wt, st, table, low, scale)
            value += f * (above[0] - value)
            by_e += f * (above[1] - by_e)
            by_d += f * (above[2] - by_d)
            by_t += f * (above[3] - by_t)
        by_e *= QUARTER * re / epidermis  # d μ^¼ / dμ = μ^¼ / 4μ; d log t / dt = 1/t
        by_d *= QUARTER * rd / dermis
        spectrum[n] = value
        slopes = parameter_slopes(x, slots, spectra, n, pigment, blood, by_e, by_d, by_t / x[2])
        for p in range(len(slots)):
            slope[n, p] = slopes[p]


@on_all_cores(PIECE, fast=True)
def spectra_and_slopes(
    start: Any, stop: Any, skins: Any, slots: Any, spectra: Any, bands: Any, blends: Any,
    table: Any, low: Any, scale: Any, out: Any, slope: Any
) -> None:  # fmt: skip
    """`spectrum_and_slope` of every skin: fills out (m, n) and slope (m, n, p)."""
    for row in range(start, stop):
        spectrum_and_slope(
            skins[row], slots, spectra, bands, blends, table, low, scale, out[row], slope[row]
        )
