"""Compiled least-squares fit of one skin per spectrum (see `spectral_fit.py`)."""

from typing import Any

import numpy as np

from cutis.albedo.slopes_kernel import chain, evaluate, workspace
from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.least_squares_kernel import minimise
from cutis.kernels.least_squares_kernel import workspace as search_space
from cutis.kernels.warp_kernel import slope_of, value_of

PIECE = 8
"""Spectra that a thread works on at a time."""
LONGEST, SHORTEST = 0.3, 1e-5
"""Steps of a coordinate: the longest, and the one that ends a fit."""
SMALL_GAIN = 1e-7
"""Relative gain of the cost that ends a fit."""
MOST = 1e300
"""More than any cost."""
FLAT = 1e-14
"""Cost per wavelength below which float32 has nothing left to improve."""


@compiled(fast=True)
def _evaluate(u: Any, problem: Any, a: Any, g: Any) -> Any:
    """Σ weight residual² at coordinates u (p,); g (p,) = Jᵀ W r and a (p, p) = Jᵀ W J."""
    y, weight, axes, model, work, slope = problem
    count = len(u)
    for p in range(count):
        work[0][p, 0] = value_of(np.float32(u[p]), axes, p)
    evaluate(model, work)
    chain(model, work, slope)
    albedo = work[1][0]
    for p in range(count):
        by_u = slope_of(np.float32(u[p]), axes, p)
        for n in range(len(y)):
            slope[n, p] *= by_u
        g[p] = 0.0
        for q in range(count):
            a[p, q] = 0.0
    cost = 0.0
    for n in range(len(y)):
        w = np.float64(weight[n])
        if w > 0:
            residual = np.float64(albedo[n]) - y[n]
            cost += w * residual * residual
            for p in range(count):
                lever = w * slope[n, p]
                g[p] += lever * residual
                for q in range(p + 1):
                    a[p, q] += lever * slope[n, q]
    for p in range(count):
        for q in range(p):
            a[q, p] = a[p, q]
    return cost


@on_all_cores(PIECE, fast=True)
def fit_kernel(
    start: Any, stop: Any, spectra: Any, weights: Any, starts: Any, held: Any, iterations: Any,
    axes: Any, model: Any, best: Any, matrices: Any, costs: Any
) -> None:  # fmt: skip
    """Fits every spectrum (m, n): fills best (m, p), matrices (m, p, p) and costs (m,).

    Minimises Σ weight (albedo − spectrum)² over coordinates u ∈ [0, 1]ᵖ from each of its `starts`
    (m, s, p); `held` (p,) stay where they start. `matrices` are Jᵀ W J at the end.
    """
    count = best.shape[1]
    work, search = workspace(model), search_space(count)
    slope = np.empty((spectra.shape[1], count), np.float32)
    u, low, high = np.empty(count), np.empty(count), np.empty(count)
    for p in range(count):
        low[p], high[p] = 0.0, 1.0
    least = FLAT * spectra.shape[1]
    rules = (iterations, LONGEST, 0.2, 5.0, 0.0, SHORTEST, least, SMALL_GAIN)
    for row in range(start, stop):
        costs[row] = MOST
        for s in range(starts.shape[1]):
            for p in range(count):
                u[p] = starts[row, s, p]
            problem = (spectra[row], weights[row], axes, model, work, slope)
            cost = minimise(_evaluate, problem, u, low, high, held, rules, search)
            if cost < costs[row]:
                costs[row] = cost
                for p in range(count):
                    best[row, p] = u[p]
                    for q in range(count):
                        matrices[row, p, q] = search[0][0, p, q]
