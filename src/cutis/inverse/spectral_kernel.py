"""Compiled least-squares fit of one skin per spectrum (see `spectral_fit.py`)."""

from typing import Any

import numpy as np

from cutis.albedo.sampled_kernel import spectrum_and_slope
from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 8
"""Spectra that a thread works on at a time."""
SMALL_STEP = 1e-5
"""Step, in coordinates, that ends a fit."""
SMALL_GAIN = 1e-7
"""Relative gain of the cost that ends a fit."""
FLAT = 1e-14
"""Cost per wavelength below which float32 has nothing left to improve."""


@compiled(fast=True)
def _evaluate(
    u: Any, y: Any, weight: Any, axes: Any, slots: Any, model: Any, x: Any, spectrum: Any,
    slope: Any, residual: Any
) -> Any:  # fmt: skip
    """Fills residual (n,) and slope (n, p) by coordinates u (p,); returns Σ weight residual²."""
    spectra, bands, blends, table, low, scale = model
    root_low, root_span, power = axes
    for p in range(len(slots)):
        x[p] = (root_low[p] + np.float32(u[p]) * root_span[p]) ** power[p]
    spectrum_and_slope(x, slots, spectra, bands, blends, table, low, scale, spectrum, slope)
    cost = 0.0
    for n in range(len(y)):
        residual[n] = spectrum[n] - y[n] if weight[n] > 0 else np.float32(0)
        cost += weight[n] * residual[n] * residual[n]
    for p in range(len(slots)):
        root = root_low[p] + np.float32(u[p]) * root_span[p]
        chain = power[p] * root ** (power[p] - np.float32(1)) * root_span[p]
        for n in range(len(y)):
            slope[n, p] *= chain
    return cost


@compiled(fast=True)
def _normal(slope: Any, residual: Any, weight: Any, slots: Any, a: Any, g: Any) -> None:
    """a (p, p) = Jᵀ W J, g (p,) = Jᵀ W r."""
    a[:] = 0.0
    g[:] = 0.0
    for n in range(len(residual)):
        w = np.float64(weight[n])
        if w > 0:
            for p in range(len(slots)):
                lever = w * slope[n, p]
                g[p] += lever * residual[n]
                for q in range(p + 1):
                    a[p, q] += lever * slope[n, q]
    for p in range(len(slots)):
        for q in range(p):
            a[q, p] = a[p, q]


@compiled()
def _step(a: Any, g: Any, moves: Any, damping: Any, work: Any, step: Any) -> None:
    """step = −(a + damping diag a)⁻¹ g over the coordinates that move, by Cholesky."""
    count = len(g)
    for p in range(count):
        step[p] = -g[p] if moves[p] else 0.0
        for q in range(count):
            work[p, q] = a[p, q] if moves[p] and moves[q] else 0.0
        work[p, p] = a[p, p] * (1 + damping) + 1e-12 if moves[p] else 1.0
    for j in range(count):
        for k in range(j):
            work[j, j] -= work[j, k] * work[j, k]
        work[j, j] = np.sqrt(max(work[j, j], 1e-18))
        for i in range(j + 1, count):
            for k in range(j):
                work[i, j] -= work[i, k] * work[j, k]
            work[i, j] /= work[j, j]
    for i in range(count):
        for k in range(i):
            step[i] -= work[i, k] * step[k]
        step[i] /= work[i, i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            step[i] -= work[k, i] * step[k]
        step[i] /= work[i, i]


@compiled()
def _fit_one(
    y: Any, weight: Any, starts: Any, held: Any, iterations: Any,
    axes: Any, slots: Any, model: Any, best: Any, matrix: Any
) -> Any:  # fmt: skip
    """Fills best (p,) and matrix (p, p) = Jᵀ W J there; returns the cost there."""
    count, length = len(slots), len(y)
    x, spectrum = np.empty(count, np.float32), np.empty(length, np.float32)
    slope, new_slope = np.empty((length, count), np.float32), np.empty((length, count), np.float32)
    residual, new_residual = np.empty(length, np.float32), np.empty(length, np.float32)
    u, trial, g, step = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    a, work = np.empty((count, count)), np.empty((count, count))
    moves = np.empty(count, np.bool_)
    lowest = np.inf
    for s in range(len(starts)):
        u[:] = starts[s]
        cost = _evaluate(u, y, weight, axes, slots, model, x, spectrum, slope, residual)
        _normal(slope, residual, weight, slots, a, g)
        damping = 1e-3
        for _ in range(iterations):
            for p in range(count):
                out = (u[p] <= 0.0 and g[p] > 0.0) or (u[p] >= 1.0 and g[p] < 0.0)
                moves[p] = not (held[p] or out)
            _step(a, g, moves, damping, work, step)
            size = 0.0
            for p in range(count):
                trial[p] = min(max(u[p] + min(max(step[p], -0.3), 0.3), 0.0), 1.0)
                size = max(size, abs(trial[p] - u[p]))
            if size < SMALL_STEP:
                break
            new = _evaluate(
                trial, y, weight, axes, slots, model, x, spectrum, new_slope, new_residual
            )
            gain = cost - new
            if gain > 0:
                u[:] = trial
                slope[:] = new_slope
                residual[:] = new_residual
                cost = new
                damping = max(damping * 0.2, 1e-9)
                if gain < SMALL_GAIN * cost or cost < FLAT * length:
                    break
                _normal(slope, residual, weight, slots, a, g)
            else:
                damping *= 5.0
                if damping > 1e8:
                    break
        if cost < lowest:
            lowest = cost
            best[:] = u
            _normal(slope, residual, weight, slots, matrix, g)
    return lowest


@on_all_cores(PIECE)
def fit_kernel(
    start: Any, stop: Any, spectra: Any, weights: Any, starts: Any, held: Any, iterations: Any,
    axes: Any, slots: Any, model: Any, best: Any, matrices: Any, costs: Any
) -> None:  # fmt: skip
    """Fits every spectrum (m, n): fills best (m, p), matrices (m, p, p) and costs (m,).

    Minimises Σ weight (albedo − spectrum)² over coordinates u ∈ [0, 1]ᵖ by Levenberg–Marquardt from
    each of its `starts` (m, s, p); coordinates on a bound that the slope pushes out do not move.
    `held` (p,) stay where they start.
    """
    for row in range(start, stop):
        costs[row] = _fit_one(
            spectra[row], weights[row], starts[row], held, iterations, axes, slots, model,
            best[row], matrices[row],
        )  # fmt: skip
