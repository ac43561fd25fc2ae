"""The search of `least_squares_kernel.py` in plain NumPy, to test it against."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def minimise(
    evaluate: Callable[[Array], tuple[float, Array, Array]],
    start: Array,
    low: Array,
    high: Array,
    held: NDArray[np.bool_],
    rules: tuple[int, float, float, float, float, float, float, float],
) -> tuple[Array, float]:
    """Where the cost is least and what it is there; `evaluate(u)` gives cost, A and g."""
    most, longest, ease, harden, hard, shortest, least, relative = rules
    u, damping = np.array(start, dtype=np.float64), 1e-3
    cost, a, g = evaluate(u)
    for _ in range(most):
        moves = ~(held | ((u <= low) & (g > 0)) | ((u >= high) & (g < 0)))
        inner = a[np.ix_(moves, moves)]
        step = np.zeros(len(u))
        damped = inner + np.diag(damping * np.diag(inner) + 1e-12)
        step[moves] = -np.linalg.solve(damped, g[moves])
        trial = np.clip(u + np.clip(step, -longest, longest), low, high)
        if np.abs(trial - u).max() <= shortest:
            break
        new, new_a, new_g = evaluate(trial)
        gain = cost - new
        if gain >= 0:
            u, cost, a, g = trial, new, new_a, new_g
            damping = max(damping * ease, 1e-9)
        else:
            damping = max(damping * harden, hard)
        if abs(gain) <= least + relative * cost or damping > 1e8:
            break
    return u, cost
