"""Compiled least-squares fit of one skin per spectrum (see `spectra.py`)."""

from typing import Any

import numpy as np
from numba import njit, prange

from cutis.albedo.spline import spectrum_and_slope

EDGE = np.float32(9.0)
"""Bound on logits: 0.0001 from the ends of a range."""
CONVERGED = 1e-7
"""Relative change of the cost that ends a fit."""


@njit(fastmath=True, cache=True)
def _evaluate(
    z: Any, spectrum: Any, bounds: Any, slots: Any, model: Any, x: Any, albedo: Any, slope: Any
) -> Any:
    """Sum of squared residuals; fills albedo (m,) and slope (m, 5) by logits z (5,)."""
    low, span, power = bounds
    basis, table, first, scale = model
    for p in range(5):
        u = np.float32(1) / (np.float32(1) + np.exp(-z[p]))
        x[p] = (low[p] + u * span[p]) ** power[p]
    spectrum_and_slope(x, slots, basis, table, first, scale, albedo, slope)
    total = 0.0
    for p in range(5):
        u = np.float32(1) / (np.float32(1) + np.exp(-z[p]))
        root = low[p] + u * span[p]
        chain = power[p] * root ** (power[p] - np.float32(1)) * span[p] * u * (np.float32(1) - u)
        for b in range(len(albedo)):
            slope[b, p] *= chain
    for b in range(len(albedo)):
        total += (albedo[b] - spectrum[b]) ** 2
    return total


@njit(fastmath=True, cache=True)
def _normal(z: Any, spectrum: Any, centre: Any, weight: Any, albedo: Any, slope: Any,
            a: Any, g: Any) -> None:  # fmt: skip
    """Normal equations a (5, 5), g (5,) of the residual and the weak prior."""
    for p in range(5):
        g[p] = weight[p] * (z[p] - centre[p])
        for q in range(5):
            a[p, q] = 0.0
        a[p, p] = weight[p]
    for b in range(len(albedo)):
        off = albedo[b] - spectrum[b]
        for p in range(5):
            g[p] += slope[b, p] * off
            for q in range(p + 1):
                a[p, q] += slope[b, p] * slope[b, q]
    for p in range(5):
        for q in range(p):
            a[q, p] = a[p, q]


@njit(fastmath=True, cache=True)
def _prior(z: Any, centre: Any, weight: Any) -> Any:
    total = 0.0
    for p in range(5):
        total += weight[p] * (z[p] - centre[p]) ** 2
    return total


@njit(parallel=True, fastmath=True, cache=True)
def spectra_kernel(
    spectra: Any, starts: Any, centre: Any, weight: Any, iterations: Any, bounds: Any, slots: Any,
    model: Any, best: Any, costs: Any, hessians: Any
) -> None:  # fmt: skip
    """Fills best (n, 5) logits, costs (n,) sums of squares, hessians (n, 5, 5) of spectra (n, m).

    Levenberg–Marquardt from each of `starts` (s, 5), the best of which is kept. Minimises
    |albedo − spectrum|² + Σ weight (z − centre)².
    """
    for row in prange(spectra.shape[0]):
        _fit_one(
            spectra[row], starts, centre, weight, iterations, bounds, slots, model,
            best[row], costs[row : row + 1], hessians[row],
        )  # fmt: skip


@njit(fastmath=True, cache=True)
def _fit_one(
    spectrum: Any, starts: Any, centre: Any, weight: Any, iterations: Any, bounds: Any, slots: Any,
    model: Any, best: Any, cost_out: Any, hessian: Any
) -> None:  # fmt: skip
    m = len(spectrum)
    x, z, trial = np.empty(5, np.float32), np.empty(5, np.float32), np.empty(5, np.float32)
    albedo, other = np.empty(m, np.float32), np.empty(m, np.float32)
    slope, slope_there = np.empty((m, 5), np.float32), np.empty((m, 5), np.float32)
    a, g, damped = np.empty((5, 5)), np.empty(5), np.empty((5, 5))
    least = np.inf
    for start in range(starts.shape[0]):
        z[:] = starts[start]
        squares = _evaluate(z, spectrum, bounds, slots, model, x, albedo, slope)
        cost = squares + _prior(z, centre, weight)
        damping = 1e-3
        _normal(z, spectrum, centre, weight, albedo, slope, a, g)
        for _ in range(iterations):
            damped[:] = a
            for p in range(5):
                damped[p, p] *= 1.0 + damping
            step = np.linalg.solve(damped, -g)
            for p in range(5):
                move = min(max(step[p], -2.0), 2.0)
                trial[p] = min(max(z[p] + np.float32(move), -EDGE), EDGE)
            there = _evaluate(trial, spectrum, bounds, slots, model, x, other, slope_there)
            trial_cost = there + _prior(trial, centre, weight)
            gain = cost - trial_cost
            if gain >= 0:
                z[:] = trial
                albedo[:] = other
                slope[:] = slope_there
                squares, cost = there, trial_cost
                damping *= 0.1
                _normal(z, spectrum, centre, weight, albedo, slope, a, g)
                if gain < CONVERGED * cost:
                    break
            else:
                damping = max(damping * 10.0, 1e-6)
                if damping > 1e8:
                    break
        if cost < least:
            least = cost
            best[:] = z
            cost_out[0] = squares
            hessian[:] = a
