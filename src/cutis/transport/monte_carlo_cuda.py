"""The same photon histories on a CUDA device (see `history.py` and `monte_carlo.py`)."""

from typing import Any

import numba.cuda
import numpy as np
from numpy.typing import NDArray

from cutis.transport.history import make_history

cuda: Any = numba.cuda  # whose names are made at run time
BLOCK = 64
"""Photons of one thread."""
THREADS = 128
MOST_LAYERS = 14

_history = make_history(cuda.jit(device=True))


@cuda.jit  # type: ignore[untyped-decorator]
def _kernel(
    stacks: Any, streams: Any, key: Any, first: Any, stop: Any,
    dimension: Any, index: Any, incidence: Any, sums: Any, squares: Any
) -> None:  # fmt: skip
    task = cuda.grid(1)
    cases, scored = stacks.shape[0], sums.shape[2]
    if task >= sums.shape[0] * cases:
        return
    part, case = task // cases, task % cases
    score = cuda.local.array(2 + 2 * MOST_LAYERS, np.float64)
    for photon in range(first + part * BLOCK, min(stop, first + (part + 1) * BLOCK)):
        for i in range(2 + 2 * stacks.shape[1]):
            score[i] = 0.0
        _history(
            np.uint64(photon), streams[case], key, stacks[case], dimension, index, incidence, score
        )
        for i in range(scored):
            sums[part, case, i] += score[i]
            squares[part, case, i] += score[i] * score[i]


def available() -> bool:
    """Whether a CUDA device is present."""
    return bool(cuda.is_available())


def walk_cuda(
    stacks: NDArray[np.float64], streams: NDArray[np.uint64], key: np.uint64, first: int, stop: int,
    dimension: int, index: float, incidence: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:  # fmt: skip
    """(blocks, n, L + 2) sums and sums of squares of the scores of photons `first` to `stop`."""
    parts = -(-(stop - first) // BLOCK)
    shape = (parts, len(stacks), stacks.shape[1] + 2)
    sums = cuda.to_device(np.zeros(shape))
    squares = cuda.to_device(np.zeros(shape))
    _kernel[-(-parts * len(stacks) // THREADS), THREADS](
        cuda.to_device(stacks), cuda.to_device(streams), key, first, stop,
        dimension, index, incidence, sums, squares,
    )  # fmt: skip
    return sums.copy_to_host(), squares.copy_to_host()
