"""What commands say: progress with time left, tables, one clear line for errors."""

import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

# Names of files are printed as they are: no markup, no emoji, no line breaks inside them.
out = Console(highlight=False, markup=False, emoji=False, soft_wrap=True)
err = Console(stderr=True, highlight=False, markup=False, emoji=False)


class Steps:
    """A progress bar of a known number of steps, each announced by name."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._task = progress.add_task("", total=total)
        self._begun = False
        self.interrupted = False

    def step(self, name: str) -> None:
        """Ends the step before and names the one that begins."""
        self._check()
        if self._begun:
            self._progress.advance(self._task)
        self._begun = True
        self._progress.update(self._task, description=name)

    def at(self, done: int, total: int, name: str) -> None:
        """Sets the whole bar: `done` of `total`."""
        self._check()
        self._progress.update(self._task, completed=done, total=total, description=name)

    def _check(self) -> None:
        if self.interrupted:
            raise KeyboardInterrupt


@contextmanager
def steps(total: int, quiet: bool) -> Iterator[Steps]:
    """A bar on stderr that goes away when done; none when `quiet` or when nobody watches."""
    columns = (
        TextColumn("{task.description:<24}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    hidden = quiet or not err.is_terminal
    with Progress(*columns, console=err, transient=True, disable=hidden) as progress:
        running = Steps(progress, total)

        def interrupt(*_: object) -> None:
            # Python drops exceptions raised inside callbacks of libraries, compilers among them:
            # what was dropped is raised again at the next step.
            running.interrupted = True
            raise KeyboardInterrupt

        before = signal.signal(signal.SIGINT, interrupt)
        try:
            yield running
        finally:
            signal.signal(signal.SIGINT, before)


def print_statistics(rows: Iterable[tuple[str, str, float, float, float]]) -> None:
    """A table of maps: name, unit, 5th percentile, median, 95th percentile."""
    table = Table("map", "unit", "5 %", "median", "95 %", box=None)
    for name, unit, *values in rows:
        table.add_row(name, unit, *(f"{value:.4g}" for value in values))
    out.print(table)
