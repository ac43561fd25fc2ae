"""Loops on all cores: one small pool of threads for every kernel.

Compiled kernels let go of Python's lock while they run, so plain threads are enough. Work is cut
into pieces of a fixed size, whatever the number of threads, so that this number never changes a
result. Nothing of it outlives a fork: a child makes its own pool when it first needs one.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from cutis.errors import CutisError

MOST = 1024
"""More threads than this are a slip of the pen."""

_chosen: int | None = None
_pool: ThreadPoolExecutor | None = None


def threads() -> int:
    """How many threads kernels run on.

    What `use_threads` said in this process, else the environment's CUTIS_THREADS, else the number
    of cores that this process may use. Raises CutisError when CUTIS_THREADS is no such number.
    """
    if _chosen is not None:
        return _chosen
    said = os.environ.get("CUTIS_THREADS", "").strip()
    if not said:
        return _cores()
    if not (said.isdecimal() and 1 <= int(said) <= MOST):
        raise CutisError(
            f"CUTIS_THREADS = {said!r}: it must be a whole number from 1 to {MOST}; "
            "unset it for all cores"
        )
    return int(said)


def use_threads(count: int | None) -> None:
    """Sets the number of threads of this process, as one of several should; None takes it back."""
    global _chosen, _pool
    if count is not None and not 1 <= count <= MOST:
        raise CutisError(f"threads = {count}: it must be a whole number from 1 to {MOST}")
    _chosen, _pool = count, None


def share_out(kernel: Callable[..., None], count: int, size: int, *arguments: Any) -> None:
    """Calls `kernel(start, stop, *arguments)` until 0 to `count` is done, `size` at a time."""
    starts = iter(range(0, count, size))  # its `next` is one step under Python's lock

    def work() -> None:
        for start in starts:
            kernel(start, min(start + size, count), *arguments)

    pieces = -(-count // size)
    helpers = min(threads(), pieces) - 1
    if helpers < 1:
        return work()
    helping = [_helpers().submit(work) for _ in range(helpers)]
    try:
        work()
    finally:
        _use_up(starts)  # after an interrupt nobody begins another piece
        for helper in helping:
            if not helper.cancel():  # one that has not begun need not
                helper.result()


def _helpers() -> ThreadPoolExecutor:
    global _pool
    if _pool is None:
        _pool = ThreadPoolExecutor(threads(), thread_name_prefix="cutis")
    return _pool


def _use_up(starts: Iterator[int]) -> None:
    for _ in starts:
        pass


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _forget() -> None:
    """In the child of a fork, which has the pool's memory but none of its threads."""
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)
