"""Levenberg and Marquardt's way down, inside bounds, for few unknowns [marquardt1963].

A step solves (A + damping · diag A) step = −g over the unknowns that are free to move, g being the
slope of half the cost and A what stands for its curvature (JᵀJ of least squares). One on a bound
that the slope pushes out of it does not move. Damping falls after a step that helps and rises
after one that does not. The plain form is in `least_squares.py`.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled


@compiled()
def workspace(count: Any) -> Any:
    """What `minimise` works in, for `count` unknowns."""
    return (
        np.empty((2, count, count)),
        np.empty((2, count)),
        np.empty((count, count)),
        np.empty(count),
        np.empty(count),
        np.empty(count, np.bool_),
    )


@compiled()
def minimise(
    evaluate: Any, problem: Any, u: Any, low: Any, high: Any, held: Any, rules: Any, work: Any
) -> Any:
    """Moves u (n,) to where the cost is least inside low and high (n,); returns the cost there.

    `evaluate(u, problem, a, g)` gives the cost and fills a (n, n) and g (n,); those of the end stay
    in the first of `work`. `held` (n,) says which unknowns stay. `rules` are (most steps, longest
    step of an unknown, ease and harden: factors of damping after success and after failure, damping
    after failure at least, shortest step, least gain, least gain over cost); the last three end the
    search.
    """
    matrices, slopes, factor, step, trial, moves = work
    most, longest, ease, harden, hard, shortest, least, relative = rules
    now, count = 0, len(u)
    cost = evaluate(u, problem, matrices[0], slopes[0])
    damping = 1e-3
    for _ in range(most):
        a, g = matrices[now], slopes[now]
        for p in range(count):
            out = (u[p] <= low[p] and g[p] > 0.0) or (u[p] >= high[p] and g[p] < 0.0)
            moves[p] = not (held[p] or out)
        damped_step(a, g, moves, damping, factor, step)
        size = 0.0
        for p in range(count):
            moved = u[p] + min(max(step[p], -longest), longest)
            trial[p] = min(max(moved, low[p]), high[p])
            size = max(size, abs(trial[p] - u[p]))
        if size <= shortest:
            break
        new = evaluate(trial, problem, matrices[1 - now], slopes[1 - now])
        gain = cost - new
        if gain >= 0.0:
            for p in range(count):
                u[p] = trial[p]
            cost, now = new, 1 - now
            damping = max(damping * ease, 1e-9)
        else:
            damping = max(damping * harden, hard)
        if abs(gain) <= least + relative * cost or damping > 1e8:
            break
    if now == 1:
        for p in range(count):
            slopes[0, p] = slopes[1, p]
            for q in range(count):
                matrices[0, p, q] = matrices[1, p, q]
    return cost


@compiled()
def damped_step(a: Any, g: Any, moves: Any, damping: Any, factor: Any, step: Any) -> None:
    """Fills step (n,) = −(a + damping · diag a)⁻¹ g over what `moves`, by Cholesky; 0 elsewhere."""
    count = len(g)
    for p in range(count):
        step[p] = -g[p] if moves[p] else 0.0
        for q in range(count):
            factor[p, q] = a[p, q] if moves[p] and moves[q] else 0.0
        factor[p, p] = a[p, p] * (1.0 + damping) + 1e-12 if moves[p] else 1.0
    for j in range(count):
        for k in range(j):
            factor[j, j] -= factor[j, k] * factor[j, k]
        factor[j, j] = np.sqrt(max(factor[j, j], 1e-18))
        for i in range(j + 1, count):
            for k in range(j):
                factor[i, j] -= factor[i, k] * factor[j, k]
            factor[i, j] /= factor[j, j]
    for i in range(count):
        for k in range(i):
            step[i] -= factor[i, k] * step[k]
        step[i] /= factor[i, i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            step[i] -= factor[k, i] * step[k]
        step[i] /= factor[i, i]
