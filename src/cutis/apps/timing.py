"""Times of several functions side by side, with the memory that each takes, and the floors.

The functions take turns, so that whatever else the machine does meets all of them alike.
"""

import gc
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


@dataclass
class Timed:
    """A function of no arguments; `seconds` of its runs, `peak` memory in bytes, None if unknown.

    `moved` are the bytes that it has to read and to write at least.
    """

    system: str
    step: str
    run: Callable[[], object]
    moved: int
    seconds: list[float] = field(default_factory=list)
    peak: int | None = None

    @property
    def best(self) -> float:
        """Seconds of the fastest run."""
        return min(self.seconds)

    @property
    def median(self) -> float:
        """Median seconds."""
        return float(np.median(self.seconds))


def race(entries: Sequence[Timed], repeats: int) -> Iterator[Timed]:
    """Runs every entry once for its memory, untimed, then all of them `repeats` times in turns.

    Yields each entry before it runs.
    """
    for entry in entries:
        yield entry
        entry.run()  # compiles, and lets pools of memory and threads come to be
        entry.peak = peak_memory(entry.run)
    for _ in range(repeats):
        for entry in entries:
            yield entry
            gc.collect()
            start = time.perf_counter()
            entry.run()
            entry.seconds.append(time.perf_counter() - start)


def peak_memory(run: Callable[[], object]) -> int | None:
    """Bytes by which resident memory rises at most while `run` runs; None where Linux is not."""
    gc.collect()
    try:
        CLEAR.write_text("5")  # resets the high-water mark
        before = _resident("VmRSS")
    except (OSError, KeyError):
        return None
    run()
    return max(_resident("VmHWM") - before, 0)


def _resident(name: str) -> int:
    lines = dict(line.split(":", 1) for line in STATUS.read_text().splitlines() if ":" in line)
    return int(lines[name].split()[0]) * 1024


def copy_bandwidth(threads: int, repeats: int = 7, size: int = 1 << 28) -> float:
    """Bytes per second, read and written, of copying `size` bytes by all threads."""
    source, target = np.ones(size // 4, np.float32), np.empty(size // 4, np.float32)
    parts = list(zip(np.array_split(source, threads), np.array_split(target, threads), strict=True))
    with ThreadPoolExecutor(threads) as pool:
        return (
            2
            * size
            / _best(lambda: list(pool.map(lambda p: np.copyto(p[1], p[0]), parts)), repeats)
        )


def matrix_rate(repeats: int = 5, size: int = 2048) -> float:
    """Floating-point operations per second of NumPy's float32 matrix product."""
    matrix = np.random.default_rng(0).random((size, size), dtype=np.float32)
    return 2 * size**3 / _best(lambda: matrix @ matrix, repeats)


def _best(run: Callable[[], object], repeats: int) -> float:
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    return float(best)
