"""Compiled fit of the most probable skin to a spectrum (see `expectation.py`).

Unknowns are the logits of the coordinates of p parameters, and how the dermis scatters beyond its
tissue: ln a and b. The dermis' albedo depends on μa / μs alone, so that its absorption is
multiplied by (λ / 550 nm)^b / a.
"""

from typing import Any

import numpy as np

from cutis.albedo.slopes_kernel import chain, evaluate, workspace
from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.least_squares_kernel import minimise
from cutis.kernels.least_squares_kernel import workspace as search_space
from cutis.kernels.warp_kernel import slope_of, value_of

PIECE = 8
"""Spectra that a thread works on at a time."""
EDGE, FARTHEST = 9.0, 3.0
"""Bounds on logits, and on ln a and b."""
LONGEST, SHORTEST = 1.0, 1e-5
"""Steps of an unknown: the longest, and the one that ends a fit."""
CONVERGED = 1e-7
"""Relative gain of the cost that ends a fit."""
MOST = 1e300
"""More than any cost."""
ONE = np.float32(1)


@compiled(fast=True)
def _evaluate(z: Any, problem: Any, a: Any, g: Any) -> Any:
    """Cost of unknowns z (p + 2,), the slope g of its half and a ≈ its curvature."""
    y, weight, centre, precision, held, axes, model, below, powers, work, slope = problem
    size, count = slope.shape[1], len(z)
    for n in range(len(y)):
        factor = np.float32(np.exp(z[count - 1] * powers[n] - z[count - 2]))
        for c in range(below.shape[0]):
            model[2][c, n] = below[c, n] * factor
    for p in range(size):
        u = np.float32(held[p]) if held[p] >= 0.0 else ONE / (ONE + np.exp(-np.float32(z[p])))
        work[0][p, 0] = value_of(u, axes, p)
    evaluate(model, work)
    chain(model, work, slope)
    for p in range(size):
        u = ONE / (ONE + np.exp(-np.float32(z[p])))
        by_z = slope_of(u, axes, p) * u * (ONE - u)
        for n in range(len(y)):
            slope[n, p] *= by_z
    cost = 0.0
    for p in range(count):
        g[p] = 0.0
        for q in range(count):
            g[p] += precision[p, q] * (z[q] - centre[q])
            a[p, q] = precision[p, q]
        cost += g[p] * (z[p] - centre[p])
    albedo, by_dermis, absorbed = work[1][0], work[1][2], work[3][1]
    for n in range(len(y)):
        w = np.float64(weight[n])
        if w > 0:
            residual = np.float64(albedo[n]) - y[n]
            cost += w * residual * residual
            louder = np.float64(by_dermis[n]) * absorbed[n]
            for p in range(count):
                mine = slope[n, p] if p < size else louder * (powers[n] if p > size else -1.0)
                g[p] += w * mine * residual
                for q in range(p + 1):
                    other = slope[n, q] if q < size else louder * (powers[n] if q > size else -1.0)
                    a[p, q] += w * mine * other
    for p in range(count):
        for q in range(p):
            a[q, p] = a[p, q]
    return cost


@on_all_cores(PIECE, fast=True)
def fit_expected(
    start: Any, stop: Any, spectra: Any, weights: Any, starts: Any, centre: Any, precision: Any,
    held: Any, iterations: Any, axes: Any, model: Any, powers: Any, best: Any, matrices: Any,
    costs: Any
) -> None:  # fmt: skip
    """Fits every spectrum (m, n): fills best (m, p + 2), matrices and costs (m,).

    Minimises Σ weight (albedo − spectrum)² + (z − centre)ᵀ precision (z − centre) from each of its
    `starts` (m, s, p + 2). `held` (p,) are coordinates that stay, below 0 where none is. `powers`
    (n,) are ln(λ / 550 nm). `matrices` are half the curvature at the end.
    """
    count, size = best.shape[1], best.shape[1] - 2
    work, search = workspace(model), search_space(count)
    slope = np.empty((spectra.shape[1], size), np.float32)
    below = model[2].copy()
    mine = (
        model[0], model[1], model[2].copy(), model[3], model[4], model[5], model[6], model[7],
        model[8],
    )  # fmt: skip
    z, low, high = np.empty(count), np.empty(count), np.empty(count)
    stays = np.empty(count, np.bool_)
    for p in range(count):
        high[p] = EDGE if p < size else FARTHEST
        low[p] = -high[p]
        stays[p] = p < size and held[p] >= 0.0
    rules = (iterations, LONGEST, 0.2, 5.0, 0.0, SHORTEST, 0.0, CONVERGED)
    for row in range(start, stop):
        costs[row] = MOST
        for s in range(starts.shape[1]):
            for p in range(count):
                z[p] = starts[row, s, p]
            problem = (
                spectra[row], weights[row], centre, precision, held, axes, mine, below, powers,
                work, slope,
            )  # fmt: skip
            cost = minimise(_evaluate, problem, z, low, high, stays, rules, search)
            if cost < costs[row]:
                costs[row] = cost
                for p in range(count):
                    best[row, p] = z[p]
                    for q in range(count):
                        matrices[row, p, q] = search[0][0, p, q]


@on_all_cores(PIECE, fast=True)
def scattered(
    start: Any, stop: Any, skins: Any, hidden: Any, model: Any, powers: Any, albedo: Any
) -> None:  # fmt: skip
    """Fills albedo (m, n) of skins (m, p) whose dermis scatters by `hidden` (m, 2), ln a and b."""
    work = workspace(model)
    mine = (
        model[0], model[1], model[2].copy(), model[3], model[4], model[5], model[6], model[7],
        model[8],
    )  # fmt: skip
    for row in range(start, stop):
        for n in range(albedo.shape[1]):
            factor = np.float32(np.exp(hidden[row, 1] * powers[n] - hidden[row, 0]))
            for c in range(mine[2].shape[0]):
                mine[2][c, n] = model[2][c, n] * factor
        for p in range(skins.shape[1]):
            work[0][p, 0] = skins[row, p]
        evaluate(mine, work)
        for n in range(albedo.shape[1]):
            albedo[row, n] = work[1][0, n]
