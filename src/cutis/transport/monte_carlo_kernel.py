"""Photon histories on all cores (see `history.py` and `monte_carlo.py`)."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.transport.history import make_history

_history = make_history(compiled())


@on_all_cores(1)
def walk_kernel(
    begin: Any, end: Any, stacks: Any, streams: Any, key: Any, first: Any, stop: Any, block: Any,
    dimension: Any, index: Any, incidence: Any, sums: Any, squares: Any
) -> None:  # fmt: skip
    """Adds to sums, squares (blocks, n, L + 2) what photons `first` to `stop` score, and squared.

    `stacks` (n, L, 4) and `streams` (n,) uint64, one per case. Threads change who fills an entry,
    not what it is filled with.
    """
    cases, scored = stacks.shape[0], sums.shape[2]
    for task in range(begin, end):
        part, case = task // cases, task % cases
        score = np.zeros(2 + 2 * stacks.shape[1])
        for photon in range(first + part * block, min(stop, first + (part + 1) * block)):
            for i in range(len(score)):
                score[i] = 0.0
            _history(
                np.uint64(photon), streams[case], key, stacks[case],
                dimension, index, incidence, score,
            )  # fmt: skip
            for i in range(scored):
                sums[part, case, i] += score[i]
                squares[part, case, i] += score[i] * score[i]


@on_all_cores(1)
def absorptions_kernel(
    begin: Any, end: Any, stack: Any, stream: Any, key: Any, first: Any, stop: Any, block: Any,
    dimension: Any, incidence: Any, top: Any, bottom: Any, sums: Any, squares: Any
) -> None:  # fmt: skip
    """Adds to sums, squares (blocks, E, D) the reflected weights of one set of paths.

    `stack` (2, 4) with the least absorption of each layer; `top` (E,), `bottom` (D,) further
    absorption over extinction, by which longer paths are worth less (Beer–Lambert).
    """
    for part in range(begin, end):
        score = np.zeros(6)
        low, high = np.empty(len(top)), np.empty(len(bottom))
        for photon in range(first + part * block, min(stop, first + (part + 1) * block)):
            for i in range(len(score)):
                score[i] = 0.0
            _history(np.uint64(photon), stream, key, stack, dimension, 1.0, incidence, score)
            if score[0] == 0.0:
                continue
            for e in range(len(top)):
                low[e] = score[0] * np.exp(-top[e] * score[4])
            for d in range(len(bottom)):
                high[d] = np.exp(-bottom[d] * score[5])
            for e in range(len(top)):
                for d in range(len(bottom)):
                    weight = low[e] * high[d]
                    sums[part, e, d] += weight
                    squares[part, e, d] += weight * weight
