"""Compiled albedo of one skin at any wavelengths, with exact slopes by its parameters.

The model of a tissue is a tuple: `recipe`, `above` and `below` are the mixtures of epidermis and
dermis at n wavelengths (`kernels/mixture.py`; shares of the epidermis come first). Wavelength i
lies `blends[i]` of the way from band `bands[i]` of the table to the next; what is blended is
transport, which is smooth, not absorption. `upper` (b, E+3, T+3, 8), `lower` (b, D+3, 8) are the
products of `separated.py`; `low`, `scale` (b, 3) turn μa_e^¼, μa_d^¼ and log t into cells.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.mixture_kernel import absorb_in_bands, share_slopes, shares
from cutis.kernels.spline_kernel import cell_of, cubic, cubic_slopes, node_of

PIECE = 64
"""Skins that a thread works on at a time."""
THICKNESS = 2
"""Its place among parameters."""
QUARTER = np.float32(0.25)


@compiled()
def workspace(model: Any) -> Any:
    """What `evaluate` works in: the skin (p, 1) comes first, then albedo and levers (4, n)."""
    recipe, bands = model[0], model[3]
    substances, parameters, count = recipe.shape[0], recipe.shape[1], len(bands)
    return (
        np.empty((parameters, 1), np.float32),
        np.empty((4, count), np.float32),
        np.empty((4, count), np.float32),
        np.empty((2, count), np.float32),
        np.empty((2, count), np.float32),
        np.empty((substances, 1), np.float32),
        np.empty((substances, parameters), np.float32),
        np.empty((4, 4), np.float32),
    )


@compiled(fast=True, inline=True)
def _transport(
    roots: Any, log_t: Any, bands: Any, shift: Any, upper: Any, lower: Any, low: Any, scale: Any,
    w: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (4, n) with albedo in bands + shift and its slopes by roots (2, n) and log t.

    Goes on straight where the absorption at a wavelength is beyond those of the band.
    """
    e_cells, t_cells, d_cells = upper.shape[1] - 3, upper.shape[2] - 3, lower.shape[1] - 3
    cell, f = cell_of((log_t - low[0, 2]) * scale[0, 2], np.float32(t_cells))
    k = node_of(cell, t_cells)
    w[0, 0], w[0, 1], w[0, 2], w[0, 3] = cubic(f)
    w[1, 0], w[1, 1], w[1, 2], w[1, 3] = cubic_slopes(f)
    for n in range(len(bands)):
        b = bands[n] + shift
        cell, f = cell_of((roots[0, n] - low[b, 0]) * scale[b, 0], np.float32(e_cells))
        e = node_of(cell, e_cells)
        w0, w1, w2, w3 = cubic(f)
        s0, s1, s2, s3 = cubic_slopes(f)
        cell, f = cell_of((roots[1, n] - low[b, 1]) * scale[b, 1], np.float32(d_cells))
        d = node_of(cell, d_cells)
        w[2, 0], w[2, 1], w[2, 2], w[2, 3] = cubic(f)
        w[3, 0], w[3, 1], w[3, 2], w[3, 3] = cubic_slopes(f)
        r0, r1, r2, r3, row = (
            upper[b, e],
            upper[b, e + 1],
            upper[b, e + 2],
            upper[b, e + 3],
            lower[b],
        )
        value, by_e, by_d, by_t = np.float32(0), np.float32(0), np.float32(0), np.float32(0)
        for r in range(8):  # compilers make vectors of this loop, not of the one inside
            a, a_e, a_t = np.float32(0), np.float32(0), np.float32(0)
            c, c_d = np.float32(0), np.float32(0)
            for q in range(4):
                here = w0 * r0[k + q, r] + w1 * r1[k + q, r] + w2 * r2[k + q, r] + w3 * r3[k + q, r]
                rise = s0 * r0[k + q, r] + s1 * r1[k + q, r] + s2 * r2[k + q, r] + s3 * r3[k + q, r]
                a += w[0, q] * here
                a_t += w[1, q] * here
                a_e += w[0, q] * rise
                c += w[2, q] * row[d + q, r]
                c_d += w[3, q] * row[d + q, r]
            value += a * c
            by_e += a_e * c
            by_t += a_t * c
            by_d += a * c_d
        by_e, by_d = by_e * scale[b, 0], by_d * scale[b, 1]
        high_e = low[b, 0] + np.float32(e_cells) / scale[b, 0]
        high_d = low[b, 1] + np.float32(d_cells) / scale[b, 1]
        value += by_e * (roots[0, n] - min(max(roots[0, n], low[b, 0]), high_e))
        value += by_d * (roots[1, n] - min(max(roots[1, n], low[b, 1]), high_d))
        out[0, n], out[1, n], out[2, n], out[3, n] = value, by_e, by_d, by_t * scale[b, 2]


@compiled(fast=True)
def evaluate(model: Any, work: Any) -> None:
    """Fills the levers of `work` for its skin: albedo, and its slopes by μa_e, μa_d and t."""
    recipe, above, below, bands, blends, upper, lower, low, scale = model
    x, out, ahead, absorbed, roots, h, _, w = work
    shares(x, recipe, h)
    absorb_in_bands(h, above, absorbed[0])
    absorb_in_bands(h[above.shape[0] - 1 :], below, absorbed[1])
    blended = False
    for n in range(len(bands)):
        roots[0, n] = np.sqrt(np.sqrt(absorbed[0, n]))
        roots[1, n] = np.sqrt(np.sqrt(absorbed[1, n]))
        blended |= blends[n] > 0
    log_t = np.log(x[THICKNESS, 0])
    _transport(roots, log_t, bands, 0, upper, lower, low, scale, w, out)
    if blended:
        _transport(roots, log_t, bands, 1, upper, lower, low, scale, w, ahead)
        for i in range(4):
            for n in range(len(bands)):
                out[i, n] += blends[n] * (ahead[i, n] - out[i, n])
    for n in range(len(bands)):  # d μ^¼ / dμ = μ^¼ / 4μ; d log t / dt = 1/t
        out[1, n] *= QUARTER * roots[0, n] / absorbed[0, n]
        out[2, n] *= QUARTER * roots[1, n] / absorbed[1, n]
        out[3, n] /= x[THICKNESS, 0]


@compiled(fast=True)
def chain(model: Any, work: Any, slope: Any) -> None:
    """Fills slope (n, p) with ∂albedo/∂parameter, per unit of each, of what was evaluated."""
    recipe, above, below = model[0], model[1], model[2]
    x, out, by = work[0], work[1], work[6]
    share_slopes(x[:, 0], recipe, by)
    first = above.shape[0] - 1
    for p in range(slope.shape[1]):
        for n in range(slope.shape[0]):
            slope[n, p] = out[3, n] if p == THICKNESS else np.float32(0)
        for c in range(recipe.shape[0]):
            if recipe[c, p] != 0:
                pure, lever = (
                    (above[1 + c], out[1]) if c < first else (below[1 + c - first], out[2])
                )
                for n in range(slope.shape[0]):
                    slope[n, p] += by[c, p] * lever[n] * pure[n]


@on_all_cores(PIECE, fast=True)
def spectra_and_slopes(
    start: Any, stop: Any, skins: Any, model: Any, spectra: Any, slopes: Any
) -> None:
    """Fills spectra (m, n) and slopes (m, n, p) of skins (m, p)."""
    work = workspace(model)
    for row in range(start, stop):
        for p in range(skins.shape[1]):
            work[0][p, 0] = skins[row, p]
        evaluate(model, work)
        chain(model, work, slopes[row])
        for n in range(spectra.shape[1]):
            spectra[row, n] = work[1][0, n]


@compiled(fast=True)
def colour_and_slope(
    model: Any, weights: Any, work: Any, slopes: Any, rgb: Any, slope: Any
) -> None:
    """Fills rgb (3,) and slope (3, p) of the skin of `work`: sums over bands with weights (n, 3).

    Works in slopes (n, p).
    """
    evaluate(model, work)
    chain(model, work, slopes)
    for c in range(3):
        total = np.float32(0)
        for n in range(weights.shape[0]):
            total += weights[n, c] * work[1][0, n]
        rgb[c] = total
        for p in range(slopes.shape[1]):
            slope[c, p] = np.float32(0)
        for n in range(weights.shape[0]):
            for p in range(slopes.shape[1]):
                slope[c, p] += weights[n, c] * slopes[n, p]


@on_all_cores(PIECE, fast=True)
def colours_and_slopes(
    start: Any, stop: Any, skins: Any, model: Any, weights: Any, rgb: Any, slope: Any
) -> None:
    """Fills rgb (m, 3) and slope (m, 3, p) of skins (m, p)."""
    work = workspace(model)
    slopes = np.empty((weights.shape[0], skins.shape[1]), np.float32)
    for row in range(start, stop):
        for p in range(skins.shape[1]):
            work[0][p, 0] = skins[row, p]
        colour_and_slope(model, weights, work, slopes, rgb[row], slope[row])
