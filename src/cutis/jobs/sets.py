"""Many captures: what is done already is skipped, what fails fails alone.

A set of captures shares one calibration. Work is done here, in processes of this machine, or on a
Dask cluster that sees the same files.
"""

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.inverse import Calibration
from cutis.jobs.estimate import Progress, Task, calibrated, estimate_file

PIPELINE = 2
"""Rises when results of the same input and settings change, so that they are made again."""


@dataclass(frozen=True)
class Outcome:
    """What came of a capture: its report, or in one line why there is none."""

    face: Path
    report: dict[str, Any] | None = None
    failure: str | None = None
    skipped: bool = False


def estimate_sets(
    sets: Sequence[Sequence[Task]],
    runner: "Runner",
    again: bool,
    progress: Progress,
) -> Iterator[Outcome]:
    """Estimates all captures of all sets, yielding outcomes as they come.

    Unless `again`, captures whose results are there, made from the same files with the same
    settings, are skipped.
    """
    todo: list[tuple[Task, str]] = []
    calibrations: dict[Path, Calibration] = {}
    waiting: list[tuple[Sequence[Task], dict[Path, str]]] = []
    for tasks in sets:
        try:
            marks = _marks(tasks)
        except (CutisError, OSError) as error:
            yield from (Outcome(task.face, failure=str(error)) for task in tasks)
            continue
        open_tasks = [task for task in tasks if again or not _done(task, marks[task.face])]
        yield from (Outcome(task.face, skipped=True) for task in tasks if task not in open_tasks)
        if open_tasks:
            waiting.append((tasks, {task.face: marks[task.face] for task in open_tasks}))
    for (tasks, marks), found in runner(_calibrate, waiting, progress):
        if isinstance(found, Exception):
            yield from (Outcome(face, failure=str(found)) for face in marks)
            continue
        for task in tasks:
            if task.face in marks:
                todo.append((task, marks[task.face]))
                calibrations[task.face] = found
    jobs = [(task, calibrations[task.face], mark) for task, mark in todo]
    for (task, _, _), found in runner(_estimate, jobs, progress):
        if isinstance(found, Exception):
            yield Outcome(task.face, failure=str(found))
        else:
            yield Outcome(task.face, report=found)


Runner = Callable[
    [Callable[[Any, Progress], Any], Sequence[Any], Progress], Iterator[tuple[Any, Any]]
]
"""Applies a function to items, yielding (item, result or exception) in any order."""


def _calibrate(item: tuple[Sequence[Task], dict[Path, str]], progress: Progress) -> Calibration:
    return calibrated(item[0], progress)


def _estimate(item: tuple[Task, Calibration, str], progress: Progress) -> dict[str, Any]:
    task, calibration, mark = item
    return estimate_file(task, calibration, progress, mark)


def _marks(tasks: Sequence[Task]) -> dict[Path, str]:
    """For each capture, a digest of all that its results depend on: the set's files, settings."""
    from cutis.maps.files import digest

    files = {path for task in tasks for path in (task.face, task.mask, task.regions) if path}
    known: dict[Path, str] = {}
    for path in sorted(files):
        try:
            known[path] = digest(path)
        except OSError as error:
            what = "no such file" if isinstance(error, FileNotFoundError) else str(error.strerror)
            raise CutisError(f"{path}: {what}; check the name") from error
    shared = tasks[0].settings
    config = Path(shared.ocio) if shared.ocio else None
    colours = [digest(config)] if config is not None and config.is_file() else []
    alone = "auto" not in (shared.white, shared.exposure)
    whole = sorted(known[task.face] for task in tasks)
    marks = {}
    for task in tasks:
        own = [known[path] for path in (task.face, task.mask, task.regions) if path]
        basis = [PIPELINE, asdict(task.settings), own, colours, [] if alone else whole]
        marks[task.face] = hashlib.sha256(json.dumps(basis).encode()).hexdigest()
    return marks


def _done(task: Task, mark: str) -> bool:
    """Whether the results are there; the report is written last."""
    try:
        report = json.loads(Path(f"{task.stem}.report.json").read_text("utf-8"))
    except (OSError, ValueError):
        return False
    kept = [".skin.exr", ".model.exr", *([".report.html"] if task.settings.page else [])]
    return report.get("made_from") == mark and all(
        Path(f"{task.stem}{end}").is_file() for end in kept
    )


def here(
    function: Callable[[Any, Progress], Any], items: Sequence[Any], progress: Progress
) -> Iterator[tuple[Any, Any]]:
    """A `Runner` that works in this process, one item after the other."""
    for number, item in enumerate(items):

        def of_all(done: int, total: int, name: str, number: int = number) -> None:
            share = number + done / max(total, 1)
            progress(int(1000 * share), 1000 * len(items), name)

        try:
            yield item, function(item, of_all)
        except (CutisError, OSError, MemoryError) as error:
            yield item, _told(error)


def processes(jobs: int) -> Runner:
    """A `Runner` of so many processes, each with its share of the cores."""

    def run(
        function: Callable[[Any, Progress], Any], items: Sequence[Any], progress: Progress
    ) -> Iterator[tuple[Any, Any]]:
        from concurrent.futures import ProcessPoolExecutor, as_completed
        from concurrent.futures.process import BrokenProcessPool
        from multiprocessing import get_context

        with ProcessPoolExecutor(
            min(jobs, max(1, len(items))), get_context("spawn"), _share_cores, (jobs,)
        ) as pool:
            futures = {pool.submit(quietly, item, function): item for item in items}
            try:
                for count, future in enumerate(as_completed(futures)):
                    progress(count + 1, len(items), "estimating")
                    try:
                        yield futures[future], future.result()
                    except BrokenProcessPool:
                        died = "its process died, maybe for want of memory; try fewer --jobs"
                        yield futures[future], CutisError(died)
            finally:
                pool.shutdown(cancel_futures=True)

    return run


def cluster(address: str) -> Runner:
    """A `Runner` of the workers of a Dask scheduler."""

    def run(
        function: Callable[[Any, Progress], Any], items: Sequence[Any], progress: Progress
    ) -> Iterator[tuple[Any, Any]]:
        from cutis.jobs.cluster import on_cluster

        for count, done in enumerate(on_cluster(address, quietly, items, function)):
            progress(count + 1, len(items), "estimating")
            yield done

    return run


def quietly(item: Any, function: Callable[[Any, Progress], Any]) -> Any:
    """The result of a function, or the exception that it ended in, in another process."""
    try:
        return function(item, lambda *_: None)
    except (CutisError, OSError, MemoryError) as error:
        return CutisError(_told(error).args[0])


def _told(error: Exception) -> Exception:
    if isinstance(error, CutisError):
        return error
    if isinstance(error, MemoryError):
        return CutisError("not enough memory; try fewer --jobs")
    return CutisError(f"{getattr(error, 'filename', None) or 'file system'}: {error}")


def _share_cores(jobs: int) -> None:
    """Called in a new process before its first task."""
    import OpenImageIO as oiio

    from cutis.kernels import threads, use_threads

    share = max(1, threads() // jobs)
    use_threads(share)
    oiio.attribute("threads", share)
