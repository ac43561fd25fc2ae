"""What commands say: progress with time left, tables, one clear line for errors.

Whatever is printed may quote names and texts out of files, which may hold anything: what would
direct a terminal is shown as its code.
"""

import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from cutis.errors import printable


class Said(Console):
    """A console on which texts of ours, and those of files in them, cannot direct the terminal."""

    def say(self, text: str) -> None:
        """Prints one line."""
        self.print(printable(text))


# Names of files are printed as they are: no markup, no emoji, no line breaks inside them.
out = Said(highlight=False, markup=False, emoji=False, soft_wrap=True)
err = Said(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)


class Bar:
    """A progress bar: call it with what is done, all, and what is being done."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._task = progress.add_task("", total=1)
        self.interrupted = False

    def __call__(self, done: int, total: int, doing: str) -> None:
        """Shows how far the work is, and ends it where the user asked for that."""
        if self.interrupted:
            raise KeyboardInterrupt
        self._progress.update(self._task, completed=done, total=total, description=printable(doing))


@contextmanager
def bar(quiet: bool) -> Iterator[Bar]:
    """A bar on stderr that goes away when done; none when `quiet` or when nobody watches."""
    columns = (
        TextColumn("{task.description:<24}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    hidden = quiet or not err.is_terminal
    with Progress(*columns, console=err, transient=True, disable=hidden) as progress:
        running = Bar(progress)

        def interrupt(number: int, _: Any) -> None:
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
