"""Times of several functions side by side, with the memory that each takes, and the floors.

The functions take turns, so that whatever else the machine does meets all of them alike.
"""

import gc
import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rich.table import Table

Step: TypeAlias = Callable[[NDArray[np.float32]], object]

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


def pair(
    system: str, encode: Step, decode: Step, rgb: NDArray[np.float32], skins: NDArray[np.float32]
) -> list[Timed]:
    """Encoding of colours (n, 3) and decoding of skins (n, 5) by one system."""
    moved = rgb.nbytes + skins.nbytes
    return [
        Timed(system, "encode", lambda: encode(rgb), moved),
        Timed(system, "decode", lambda: decode(skins), moved),
    ]


def race(entries: Sequence[Timed], repeats: int, seconds: float = math.inf) -> Iterator[Timed]:
    """Runs every entry once for its memory, untimed, then all of them `repeats` times in turns.

    No round but the first begins after so many seconds. Yields each entry before it runs.
    """
    for entry in entries:
        yield entry
        entry.run()  # compiles, and lets pools of memory and threads come to be
        entry.peak = peak_memory(entry.run)
    end = time.monotonic() + seconds
    for turn in range(repeats):
        if turn and time.monotonic() >= end:
            return
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


def table(entries: Sequence[Timed], bandwidth: float, rivals: Sequence[str] = ()) -> "Table":
    """Times, memory, and ratios: to the fastest of `rivals`, and to the floor, copying memory."""
    from rich.table import Table

    by_system: dict[str, list[Timed]] = {}
    for entry in entries:
        by_system.setdefault(entry.system, []).append(entry)
    rival = fastest(entries, rivals)
    theirs = {e.step: e.best for e in by_system.get(rival or "", [])}
    result = Table(box=None)
    headings = ["", "", "best", "median", *(["ratio"] if rival else []), "copying", "memory"]
    for heading in headings:
        result.add_column(heading, justify="right" if heading else "left", no_wrap=True)

    def add(system: str, step: str, best: float, their: float | None, *rest: str) -> None:
        ratio = f"{their / best:.2f}" if their else ""
        cells = [system, step, f"{best:.3f} s", *rest]
        if rival:
            cells.insert(4, ratio)
        result.add_row(*cells)

    for system, own in by_system.items():
        for entry in own:
            add(
                system if entry is own[0] else "", entry.step, entry.best, theirs.get(entry.step),
                f"{entry.median:.3f} s", f"{100 * entry.moved / bandwidth / entry.best:.1f} %",
                "" if entry.peak is None else f"{entry.peak / 1e6:.0f} MB",
            )  # fmt: skip
        if {e.step for e in own} == {"encode", "decode"}:
            total = sum(e.best for e in own)
            add("", "both", total, sum(theirs.values()) or None, "", "", "")
    return result


def fastest(entries: Sequence[Timed], systems: Sequence[str]) -> str | None:
    """Of some systems, the one that takes least for all of its steps; None if none was timed."""
    totals = {
        system: sum(entry.best for entry in entries if entry.system == system) for system in systems
    }
    return min((s for s in systems if totals[s]), key=totals.__getitem__, default=None)


@contextmanager
def announced(quiet: bool) -> Iterator[Callable[[str], None]]:
    """Says what is going on: in one line that changes, or line by line where no terminal is."""
    from cutis.apps.console import err

    if quiet:
        yield lambda text: None
    elif err.is_terminal:
        with err.status("") as status:
            yield status.update
    else:
        yield err.print


def copy_bandwidth(threads: int, repeats: int = 7, size: int = 1 << 27) -> float:
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
