"""Compiled least-squares fit of one skin per colour (see `fit.py`)."""

from typing import Any

import numpy as np

from cutis.albedo.slopes_kernel import colour_and_slope, workspace
from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.least_squares_kernel import minimise
from cutis.kernels.least_squares_kernel import workspace as search_space
from cutis.kernels.warp_kernel import slope_of, value_of

PIECE = 64
"""Colours that a thread works on at a time."""
EDGE = 9.0
"""Bound on logits: 0.0001 from the ends of a range."""
LONGEST = 2.0
"""Step of a logit."""
CONVERGED = 1e-4
"""Change of the cost, in squared standard deviations of the prior, that ends a fit."""
ONE = np.float32(1)


@compiled(fast=True)
def _evaluate(z: Any, problem: Any, a: Any, g: Any) -> Any:
    """Cost of logits z (p,), the slope g (p,) of its half and a (p, p) ≈ its curvature."""
    colour, centre, weight, precision, axes, model, to_rgb, work, slopes, rgb, slope = problem
    count = len(z)
    for p in range(count):
        work[0][p, 0] = value_of(ONE / (ONE + np.exp(-np.float32(z[p]))), axes, p)
    colour_and_slope(model, to_rgb, work, slopes, rgb, slope)
    cost = 0.0
    for c in range(3):
        rgb[c] = (rgb[c] - colour[c]) * weight
        cost += rgb[c] * rgb[c]
    for p in range(count):
        u = ONE / (ONE + np.exp(-np.float32(z[p])))
        chain = slope_of(u, axes, p) * u * (ONE - u) * weight
        for c in range(3):
            slope[c, p] *= chain
    for p in range(count):
        g[p] = 0.0
        for q in range(count):
            g[p] += precision[p, q] * (z[q] - centre[q])
            a[p, q] = precision[p, q]
            for c in range(3):
                a[p, q] += slope[c, p] * slope[c, q]
        cost += g[p] * (z[p] - centre[p])
        for c in range(3):
            g[p] += slope[c, p] * rgb[c]
    return cost


@on_all_cores(PIECE, fast=True)
def fit_kernel(
    start: Any, stop: Any, colours: Any, centres: Any, weights: Any, precision: Any,
    iterations: Any, axes: Any, model: Any, to_rgb: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, p) with the best logits, from `centres` (n, p).

    Minimises |weight (RGB − colour)|² + (z − centre)ᵀ precision (z − centre) of each colour.
    """
    count = out.shape[1]
    work, search = workspace(model), search_space(count)
    slopes = np.empty((to_rgb.shape[0], count), np.float32)
    rgb, slope = np.empty(3, np.float32), np.empty((3, count), np.float32)
    z, low, high = np.empty(count), np.empty(count), np.empty(count)
    held = np.empty(count, np.bool_)
    for p in range(count):
        low[p], high[p], held[p] = -EDGE, EDGE, False
    rules = (iterations, LONGEST, 0.1, 10.0, 1e-3, 0.0, CONVERGED, 0.0)
    for row in range(start, stop):
        for p in range(count):
            z[p] = centres[row, p]
        problem = (
            colours[row], centres[row], weights[row], precision, axes, model, to_rgb, work, slopes,
            rgb, slope,
        )  # fmt: skip
        minimise(_evaluate, problem, z, low, high, held, rules, search)
        for p in range(count):
            out[row, p] = z[p]
