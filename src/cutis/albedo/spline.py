"""Compiled evaluation of a spectral table: parameters → RGB and its gradients, node by node.

Kernels run over texels on all cores, in float32. Parameters (n, 5) are in their units and order;
a sixth, where there are six, is the blood of the epidermis; of eight, the last three are bilirubin,
β-carotene and methaemoglobin. `slots` is a tuple with an entry for each parameter: its length is
their number, and unlike that of an array the compiler knows it. `spectra` (6, bands) holds μa of
eumelanin, pheomelanin, bare epidermis, deoxygenated blood, oxygenated blood and bare dermis; (10,
bands) also bilirubin in the dermis, β-carotene in the epidermis and in the dermis, per g/L, and
blood of methaemoglobin; `low`, `scale` (bands, 3) turn μa_e^¼, μa_d^¼ and log t into
cells. Tests hold the result against the exact solver.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 256
"""Texels that a thread works on at a time."""
ONE, HALF = np.float32(1), np.float32(0.5)
SIXTH, TWO_THIRDS = np.float32(1 / 6), np.float32(2 / 3)


@compiled(fast=True, inline=True)
def cubic_weights(f: Any) -> Any:
    """The four cubic B-spline weights at fraction f of a cell."""
    g = ONE - f
    return (
        g * g * g * SIXTH,
        TWO_THIRDS - f * f * (ONE - HALF * f),
        TWO_THIRDS - g * g * (ONE - HALF * g),
        f * f * f * SIXTH,
    )


@compiled(fast=True, inline=True)
def weight_slopes(f: Any) -> Any:
    """Derivatives of `cubic_weights` by f."""
    g, three_halves, two = ONE - f, np.float32(1.5), np.float32(2)
    return (
        -HALF * g * g,
        f * (three_halves * f - two),
        -g * (three_halves * g - two),
        HALF * f * f,
    )


@compiled(fast=True, inline=True)
def locate_cell(x: Any, low: Any, scale: Any, count: Any) -> Any:
    """Index of the cell that x falls in and the fraction of the way through it."""
    cells = count - 3
    p = min(max((x - low) * scale, np.float32(0)), np.float32(cells))
    i = max(min(int(p), cells - 1), 0)  # what NaN is as an integer must not leave the table
    return i, p - np.float32(i)


@compiled(fast=True, inline=True)
def _sum(c: Any, i: Any, j: Any, k: Any, we: Any, wd: Any, wt: Any) -> Any:
    """Tensor-product sum of the 4 × 4 × 4 coefficients at cell (i, j, k)."""
    total = np.float32(0)
    for p in range(4):
        line = np.float32(0)
        for q in range(4):
            r = c[i + p, j + q]
            line += wd[q] * (wt[0] * r[k] + wt[1] * r[k + 1] + wt[2] * r[k + 2] + wt[3] * r[k + 3])
        total += we[p] * line
    return total


@compiled(fast=True, inline=True)
def quadratic_weights(f: Any) -> Any:
    """The three quadratic B-spline weights at fraction f of a cell."""
    g = ONE - f
    return HALF * g * g, HALF + f * g, HALF * f * f


@compiled(fast=True, inline=True)
def place_in_cells(x: Any, low: Any, scale: Any, cells: Any) -> Any:
    """`locate_cell` in a form that compilers run on many x at once.

    The cell is a whole float32, `cells` their number as one.
    """
    p = min(max((x - low) * scale, np.float32(0)), cells)
    cell = np.floor(min(p, cells - HALF))
    return cell, p - cell


@compiled(fast=True, inline=True)
def first_node(cell: Any, cells: Any) -> Any:
    """A cell of `place_in_cells` as an index, inside the table even when x was NaN."""
    return min(max(int(cell), 0), cells - 1)


@compiled(fast=True, inline=True)
def mixtures(x: Any, slots: Any, spectra: Any, b: Any) -> Any:
    """μa of melanin, of blood, of epidermis and of dermis at band b, cm⁻¹."""
    pigment = x[3] * spectra[0, b] + (ONE - x[3]) * spectra[1, b]
    blood = x[4] * spectra[4, b] + (ONE - x[4]) * spectra[3, b]
    if len(slots) == 8:
        blood += x[7] * (spectra[9, b] - blood)
    epidermis = x[0] * pigment + (ONE - x[0]) * spectra[2, b]
    dermis = x[1] * blood + (ONE - x[1]) * spectra[5, b]
    if len(slots) == 6:
        epidermis += x[5] * (blood - spectra[2, b])
    if len(slots) == 8:
        epidermis += x[6] * spectra[7, b]
        dermis += x[5] * spectra[6, b] + x[6] * spectra[8, b]
    return pigment, blood, epidermis, dermis


@compiled(fast=True)  # not inlined: tuples of three lengths, of which types allow but one
def parameter_slopes(
    x: Any, slots: Any, spectra: Any, b: Any, pigment: Any, blood: Any, by_e: Any, by_d: Any,
    by_t: Any
) -> Any:  # fmt: skip
    """Slopes by each parameter from those by μa of epidermis and dermis and by thickness."""
    oxygen = spectra[4, b] - spectra[3, b]
    by_melanin = by_e * (pigment - spectra[2, b])
    by_blood = by_d * (blood - spectra[5, b])
    by_eumelanin = by_e * x[0] * (spectra[0, b] - spectra[1, b])
    by_oxygen = by_d * x[1] * oxygen
    if len(slots) == 6:
        by_oxygen += by_e * x[5] * oxygen
        by_red = by_e * (blood - spectra[2, b])
        return by_melanin, by_blood, by_t, by_eumelanin, by_oxygen, by_red
    if len(slots) == 8:
        red = x[4] * spectra[4, b] + (ONE - x[4]) * spectra[3, b]
        return (
            by_melanin,
            by_blood,
            by_t,
            by_eumelanin,
            by_oxygen * (ONE - x[7]),
            by_d * spectra[6, b],
            by_e * spectra[7, b] + by_d * spectra[8, b],
            by_d * x[1] * (spectra[9, b] - red),
        )
    return by_melanin, by_blood, by_t, by_eumelanin, by_oxygen


@compiled(fast=True)
def rgb_and_slope(
    x: Any, slots: Any, spectra: Any, table: Any, low: Any, scale: Any, to_rgb: Any, rgb: Any,
    slope: Any
) -> None:  # fmt: skip
    """Fills rgb (3,) and slope (3, n) = ∂RGB/∂parameter, per unit of each, of one skin x (n,)."""
    quarter = np.float32(0.25)
    k, ft = locate_cell(np.log(x[2]), low[0, 2], scale[0, 2], table.shape[3])
    wt, dwt = cubic_weights(ft), weight_slopes(ft)
    rgb[:] = 0
    slope[:] = 0
    for b in range(table.shape[0]):
        pigment, blood, epidermis, dermis = mixtures(x, slots, spectra, b)
        re, rd = np.sqrt(np.sqrt(epidermis)), np.sqrt(np.sqrt(dermis))
        i, fe = locate_cell(re, low[b, 0], scale[b, 0], table.shape[1])
        j, fd = locate_cell(rd, low[b, 1], scale[b, 1], table.shape[2])
        we, wd, c = cubic_weights(fe), cubic_weights(fd), table[b]
        albedo = _sum(c, i, j, k, we, wd, wt)
        # d μ^¼ / dμ = μ^¼ / 4μ; d log t / dt = 1/t
        by_e = _sum(c, i, j, k, weight_slopes(fe), wd, wt) * scale[b, 0] * quarter * re / epidermis
        by_d = _sum(c, i, j, k, we, weight_slopes(fd), wt) * scale[b, 1] * quarter * rd / dermis
        by_t = _sum(c, i, j, k, we, wd, dwt) * scale[b, 2] / x[2]
        partials = parameter_slopes(x, slots, spectra, b, pigment, blood, by_e, by_d, by_t)
        for channel in range(3):
            weight = to_rgb[b, channel]
            rgb[channel] += albedo * weight
            for p in range(len(slots)):
                slope[channel, p] += partials[p] * weight


@on_all_cores(PIECE, fast=True)
def rgb_gradient_kernel(
    start: Any,
    stop: Any,
    skins: Any,
    slots: Any,
    spectra: Any,
    table: Any,
    low: Any,
    scale: Any,
    to_rgb: Any,
    out: Any,
    slope: Any,
) -> None:
    """`rgb_and_slope` of every skin: fills out (n, 3) and slope (n, 3, p)."""
    for row in range(start, stop):
        rgb_and_slope(skins[row], slots, spectra, table, low, scale, to_rgb, out[row], slope[row])
