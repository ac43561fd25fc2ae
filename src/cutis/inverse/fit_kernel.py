"""Compiled least-squares fit of one skin per colour (see `fit.py`)."""

from typing import Any

import numpy as np

from cutis.albedo.spline import rgb_and_slope
from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 64
"""Colours that a thread works on at a time."""
EDGE = np.float32(9.0)
"""Bound on logits: 0.0001 from the ends of a range."""

CONVERGED = np.float32(1e-4)
"""Change of the cost, in squared standard deviations of the prior, that ends a fit."""


@compiled(fast=True)
def _evaluate(
    z: Any, weight: Any, colour: Any, root_low: Any, root_span: Any, power: Any, slots: Any,
    model: Any, x: Any, rgb: Any, slope: Any, residual: Any
) -> None:  # fmt: skip
    """Weighted residual (3,) and its slope (3, n) by logits z (n,)."""
    spectra, table, low, scale, to_rgb = model
    for p in range(len(slots)):
        u = np.float32(1) / (np.float32(1) + np.exp(-z[p]))
        root = root_low[p] + u * root_span[p]
        x[p] = root ** power[p]
    rgb_and_slope(x, slots, spectra, table, low, scale, to_rgb, rgb, slope)
    for p in range(len(slots)):
        u = np.float32(1) / (np.float32(1) + np.exp(-z[p]))
        root = root_low[p] + u * root_span[p]
        outer = power[p] * root ** (power[p] - np.float32(1))  # d root^power / d root
        chain = outer * root_span[p] * u * (np.float32(1) - u)
        for c in range(3):
            slope[c, p] *= chain * weight
    for c in range(3):
        residual[c] = (rgb[c] - colour[c]) * weight


@compiled(fast=True)
def _cost(z: Any, slots: Any, centre: Any, precision: Any, residual: Any) -> Any:
    total = np.float32(0)
    for c in range(3):
        total += residual[c] * residual[c]
    for p in range(len(slots)):
        for q in range(len(slots)):
            total += (z[p] - centre[p]) * precision[p, q] * (z[q] - centre[q])
    return total


@compiled(fast=True)
def _solve(a: Any, g: Any, slots: Any, step: Any) -> None:
    """step (n,) = −a⁻¹ g by Cholesky, in place; a (n, n) symmetric positive definite."""
    count = len(slots)
    for j in range(count):
        for k in range(j):
            a[j, j] -= a[j, k] * a[j, k]
        a[j, j] = np.sqrt(max(a[j, j], 1e-12))
        for i in range(j + 1, count):
            for k in range(j):
                a[i, j] -= a[i, k] * a[j, k]
            a[i, j] /= a[j, j]
    for i in range(count):
        s = -g[i]
        for k in range(i):
            s -= a[i, k] * step[k]
        step[i] = s / a[i, i]
    for i in range(count - 1, -1, -1):
        s = step[i]
        for k in range(i + 1, count):
            s -= a[k, i] * step[k]
        step[i] = s / a[i, i]


@on_all_cores(PIECE, fast=True)
def fit_kernel(
    start: Any, stop: Any, colours: Any, centres: Any, weights: Any, precision: Any,
    iterations: Any, root_low: Any, root_span: Any, power: Any, slots: Any, model: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, p) with the best logits, by Levenberg–Marquardt from `centres` (n, p).

    Minimises |weight (RGB − colour)|² + (z − centre)ᵀ precision (z − centre) of each colour.
    """
    count = len(slots)
    x, rgb, residual = np.empty(count, np.float32), np.empty(3, np.float32), np.empty(3, np.float32)
    slope, trial_slope = np.empty((3, count), np.float32), np.empty((3, count), np.float32)
    trial, trial_residual = np.empty(count, np.float32), np.empty(3, np.float32)
    a, g, step = np.empty((count, count)), np.empty(count), np.empty(count)
    for row in range(start, stop):
        z, centre, colour, weight = out[row], centres[row], colours[row], weights[row]
        z[:] = centre
        damping = 1e-3
        _evaluate(
            z, weight, colour, root_low, root_span, power, slots, model, x, rgb, slope, residual,
        )  # fmt: skip
        cost = _cost(z, slots, centre, precision, residual)
        for _ in range(iterations):
            for p in range(count):
                g[p] = 0.0
                for q in range(count):
                    g[p] += precision[p, q] * (z[q] - centre[q])
                    a[p, q] = precision[p, q]
                    for c in range(3):
                        a[p, q] += slope[c, p] * slope[c, q]
                for c in range(3):
                    g[p] += slope[c, p] * residual[c]
                a[p, p] *= 1.0 + damping
            _solve(a, g, slots, step)
            for p in range(count):
                move = min(max(step[p], -2.0), 2.0)
                trial[p] = min(max(z[p] + np.float32(move), -EDGE), EDGE)
            _evaluate(
                trial, weight, colour, root_low, root_span, power, slots, model,
                x, rgb, trial_slope, trial_residual,
            )  # fmt: skip
            trial_cost = _cost(trial, slots, centre, precision, trial_residual)
            gain = cost - trial_cost
            if gain >= 0:
                z[:] = trial
                slope[:] = trial_slope
                residual[:] = trial_residual
                cost = trial_cost
                damping *= 0.1
            else:
                damping = max(damping * 10.0, 1e-3)
            if abs(gain) < CONVERGED:
                break
