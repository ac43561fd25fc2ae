"""Compiled fits of many skins under shared constants that vary; see `calibrate_tissue.py`.

The albedo at one wavelength depends on μa_e / μs_e, μa_d / μs_d and t μs_e alone (and on g, the
boundary and the dimension), since a half space has no length. One table of these per wavelength
serves every choice of absorption and scattering, with exact slopes by all of them.
"""

from typing import Any

import numpy as np
from numba import njit, prange

from cutis.albedo.spectral_table import chebyshev, to_splines
from cutis.optics import PARAMETERS
from cutis.transport import two_layer_albedo

NODES, CELLS = (22, 22, 18), (30, 30, 22)
LOW, HIGH = np.array([0.06, 0.04, np.log(0.02)]), np.array([2.2, 2.0, np.log(40.0)])
SCALE = np.array(CELLS) / (HIGH - LOW)
ROOT = np.array([float(p.root) for p in PARAMETERS])
LEAST = np.array([p.low ** (1 / p.root) for p in PARAMETERS])
SPAN = np.array([p.high ** (1 / p.root) for p in PARAMETERS]) - LEAST


def dimensionless_table(anisotropy: np.ndarray, dimension: int, index: float) -> np.ndarray:
    """(bands, …) B-splines over (μa_e/μs_e)^¼, (μa_d/μs_d)^¼ and log t μs_e; 4 s."""
    axes = [LOW[a] + chebyshev(NODES[a]) * (HIGH[a] - LOW[a]) for a in range(3)]
    tables = []
    for g in anisotropy:
        values = two_layer_albedo(
            axes[0] ** 4, axes[1] ** 4, 1e4 * np.exp(axes[2]), 1.0, float(g),
            dimension=dimension, refractive_index=index, count=20,
        )  # fmt: skip
        for a in range(3):
            matrix = to_splines(NODES[a], CELLS[a])
            values = np.moveaxis(np.tensordot(matrix, values, axes=(1, a)), 0, a)
        tables.append(values)
    return np.ascontiguousarray(tables)


@njit(inline="always")
def _weights(f: Any) -> Any:
    g = 1 - f
    return g**3 / 6, 2 / 3 - f * f * (1 - f / 2), 2 / 3 - g * g * (1 - g / 2), f**3 / 6


@njit(inline="always")
def _slopes(f: Any) -> Any:
    g = 1 - f
    return -g * g / 2, f * (1.5 * f - 2), -g * (1.5 * g - 2), f * f / 2


@njit(inline="always")
def _cell(x: Any, axis: Any) -> Any:
    p = min(max((x - LOW[axis]) * SCALE[axis], 0.0), float(CELLS[axis]))
    i = min(int(p), CELLS[axis] - 1)
    return i, p - i


@njit
def _albedo(c: Any, e: Any, d: Any, log_t: Any) -> Any:
    """Albedo and its slopes by log e, log d and log t."""
    root_e, root_d = e**0.25, d**0.25
    (i, fe), (j, fd), (k, ft) = _cell(root_e, 0), _cell(root_d, 1), _cell(log_t, 2)
    we, wd, wt = _weights(fe), _weights(fd), _weights(ft)
    se, sd, st = _slopes(fe), _slopes(fd), _slopes(ft)
    value, by_e, by_d, by_t = 0.0, 0.0, 0.0, 0.0
    for p in range(4):
        line, line_d, line_t = 0.0, 0.0, 0.0
        for q in range(4):
            here, rise = 0.0, 0.0
            for m in range(4):
                z = c[i + p, j + q, k + m]
                here += wt[m] * z
                rise += st[m] * z
            line += wd[q] * here
            line_d += sd[q] * here
            line_t += wd[q] * rise
        value += we[p] * line
        by_e += se[p] * line
        by_d += we[p] * line_d
        by_t += we[p] * line_t
    return value, by_e * SCALE[0] * root_e / 4, by_d * SCALE[1] * root_d / 4, by_t * SCALE[2]


@njit
def evaluate(
    u: Any, y: Any, spectra: Any, d_spectra: Any, table: Any, rho: Any, residual: Any,
    by_skin: Any, by_shared: Any
) -> Any:  # fmt: skip
    """Residual (n,), its slopes by coordinates (n, 5) and by constants (n, q + 1), ρ the last.

    `spectra` (8, n): μa of eumelanin, pheomelanin, bare epidermis, deoxygenated and oxygenated
    blood, bare dermis; μs of epidermis and dermis. `d_spectra` (q, 8, n) their slopes. Returns the
    sum of squares; fills `by_shared` only where it has columns.
    """
    x, chain = np.empty(5), np.empty(5)
    for p in range(5):
        root = LEAST[p] + u[p] * SPAN[p]
        x[p] = root ** ROOT[p]
        chain[p] = ROOT[p] * root ** (ROOT[p] - 1) * SPAN[p]
    cost, shared = 0.0, d_spectra.shape[0]
    for b in range(len(y)):
        eu, ph, bare, hb, hbo = (
            spectra[0, b], spectra[1, b], spectra[2, b], spectra[3, b], spectra[4, b],
        )  # fmt: skip
        base, s, sd = spectra[5, b], spectra[6, b], spectra[7, b]
        pigment, blood = x[3] * eu + (1 - x[3]) * ph, x[4] * hbo + (1 - x[4]) * hb
        e, d = x[0] * pigment + (1 - x[0]) * bare, x[1] * blood + (1 - x[1]) * base
        a, ae, ad, at = _albedo(table[b], e / s, d / sd, np.log(x[2] * 1e-4 * s))
        k = 1 - rho
        residual[b] = rho + k * a - y[b]
        cost += residual[b] ** 2
        by_e, by_d = k * ae / e, k * ad / d
        by_skin[b, 0] = by_e * (pigment - bare) * chain[0]
        by_skin[b, 1] = by_d * (blood - base) * chain[1]
        by_skin[b, 2] = k * at / x[2] * chain[2]
        by_skin[b, 3] = by_e * x[0] * (eu - ph) * chain[3]
        by_skin[b, 4] = by_d * x[1] * (hbo - hb) * chain[4]
        if by_shared.shape[1]:
            for q in range(shared):
                c = d_spectra[q, :, b]
                de = x[0] * (x[3] * c[0] + (1 - x[3]) * c[1]) + (1 - x[0]) * c[2]
                dd = x[1] * (x[4] * c[4] + (1 - x[4]) * c[3]) + (1 - x[1]) * c[5]
                scatter = k * (at - ae) * c[6] / s - k * ad * c[7] / sd
                by_shared[b, q] = by_e * de + by_d * dd + scatter
            by_shared[b, shared] = 1 - a
    return cost


@njit
def _normal(residual: Any, by_skin: Any, u: Any, a: Any, g: Any) -> None:
    """JᵀJ and Jᵀr with rows of coordinates that rest on a bound made trivial."""
    a[:], g[:] = by_skin.T @ by_skin, by_skin.T @ residual
    for p in range(5):
        if (u[p] <= 1e-9 and g[p] > 0) or (u[p] >= 1 - 1e-9 and g[p] < 0):
            a[p, :], a[:, p], g[p] = 0.0, 0.0, 0.0
            a[p, p] = 1.0


@njit
def _fit_one(starts: Any, y: Any, spectra: Any, table: Any, rho: Any, best: Any) -> Any:
    n = len(y)
    none, empty = np.zeros((0, 8, n)), np.empty((n, 0))
    residual, new_residual = np.empty(n), np.empty(n)
    slope, new_slope = np.empty((n, 5)), np.empty((n, 5))
    a, g, u, trial = np.empty((5, 5)), np.empty(5), np.empty(5), np.empty(5)
    lowest = np.inf
    for start in range(len(starts)):
        u[:] = starts[start]
        cost = evaluate(u, y, spectra, none, table, rho, residual, slope, empty)
        damping = 1e-3
        for _ in range(60):
            _normal(residual, slope, u, a, g)
            for p in range(5):
                a[p, p] = a[p, p] * (1 + damping) + 1e-12
            step = np.linalg.solve(a, -g)
            for p in range(5):
                trial[p] = min(max(u[p] + min(max(step[p], -0.3), 0.3), 0.0), 1.0)
            if np.abs(trial - u).max() < 1e-6 or damping > 1e8:
                break
            new = evaluate(trial, y, spectra, none, table, rho, new_residual, new_slope, empty)
            if new < cost:
                done = cost - new < 1e-7 * cost
                cost, u[:], residual[:], slope[:] = new, trial, new_residual, new_slope
                damping = max(damping * 0.2, 1e-9)
                if done:
                    break
            else:
                damping *= 5
        if cost < lowest:
            lowest, best[:] = cost, u
    return lowest


@njit(parallel=True)
def fit_skins(starts: Any, y: Any, spectra: Any, table: Any, rho: Any, best: Any) -> Any:
    """Coordinates `best` (m, 5) of spectra y (m, n) from starts (m, s, 5); sums of squares (m,)."""
    cost = np.empty(len(y))
    for i in prange(len(y)):
        cost[i] = _fit_one(starts[i], y[i], spectra, table, rho, best[i])
    return cost


@njit(parallel=True)
def reduced(
    u: Any, y: Any, spectra: Any, d_spectra: Any, table: Any, rho: Any
) -> Any:  # fmt: skip
    """Residuals (m, n), and their slopes by constants (m, n, q + 1) once skins have followed.

    J_shared − J_skin (J_skinᵀ J_skin)⁻¹ J_skinᵀ J_shared: the variable projection of Kaufman.
    """
    m, n = y.shape
    count = d_spectra.shape[0] + 1
    residuals, slopes = np.empty((m, n)), np.empty((m, n, count))
    for i in prange(m):
        by_skin, by_shared = np.empty((n, 5)), np.empty((n, count))
        a, g = np.empty((5, 5)), np.empty(5)
        evaluate(u[i], y[i], spectra, d_spectra, table, rho, residuals[i], by_skin, by_shared)
        _normal(residuals[i], by_skin, u[i], a, g)
        lever = by_skin.T @ by_shared
        for p in range(5):
            if a[p, p] == 1.0 and g[p] == 0.0:
                lever[p, :] = 0.0
            a[p, p] += 1e-10
        slopes[i] = by_shared - by_skin @ np.linalg.solve(a, lever)
    return residuals, slopes
