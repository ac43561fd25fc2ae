"""Sets of captures: what is done already is skipped, what fails fails alone.

Each job is one set. Its captures are surveyed together where that is asked for, and then estimated
one by one, wherever the runner does its work.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cutis.errors import CutisError
from cutis.jobs.files import check_outputs
from cutis.jobs.outcome import Asked, CaptureFiles, Estimated
from cutis.jobs.results import look
from cutis.jobs.runners import Runner, in_one_line
from cutis.maps import Surveyed
from cutis.maps.estimating import Progress
from cutis.report import Report

if TYPE_CHECKING:
    from cutis.jobs.estimate import EstimateJob

FLAGS = {
    "light": "--illuminant", "page": "--report", "sigma": "--no-sigma",
    "output_colorspace": "--output-colorspace",
}  # fmt: skip
"""What people call fields of the job that have another name."""


@dataclass(frozen=True)
class _Open:
    """A set with captures to estimate, what they depend on, and what changed of each."""

    job: "EstimateJob"
    todo: dict[CaptureFiles, Asked]
    changed: dict[CaptureFiles, tuple[str, ...]]


def estimate_sets(
    jobs: "Sequence[EstimateJob]", runner: Runner, progress: Progress
) -> Iterator[Estimated]:
    """Estimates all captures of all sets, yielding one outcome for each, as they come.

    Captures whose results are there, made of the same in the same way, are skipped. Where the
    content behind a flag has changed they are made again; where flags have, they fail, naming
    those, unless the job says `again`.
    """
    jobs, waiting = [job.absolute() for job in jobs], list[_Open]()
    read: dict[str, Path | None] = {}
    for one in (one for job in jobs for one in job.captures):
        read[f"the capture {one.face.name}"] = one.face
        for what, path in (("mask", one.mask), ("picture of regions", one.regions)):
            if path is not None:
                read[f"the {what} {path.name}"] = path
    for job in jobs:
        for capture in job.captures:
            check_outputs(job.outputs(capture), read)
    for job in jobs:
        outcomes, opened = _sorted_out(job)
        yield from outcomes
        if opened.todo:
            waiting.append(opened)
    todo: list[tuple[_Open, CaptureFiles, Surveyed]] = []
    for opened, known in runner(_survey, waiting, progress):
        if isinstance(known, Exception):
            yield from (Estimated(capture.face, failure=str(known)) for capture in opened.todo)
        else:
            todo += [(opened, capture, known) for capture in opened.todo]
    for (opened, capture, _), found in runner(_estimate, todo, progress):
        if isinstance(found, Exception):
            yield Estimated(capture.face, failure=str(found))
        else:
            yield _arrived(opened, capture, found)


def _sorted_out(job: "EstimateJob") -> tuple[list[Estimated], _Open]:
    """Outcomes that are known before any work, and what is left to do."""
    outcomes, opened, shared = [], _Open(job, {}, {}), job.shared()
    for capture in job.captures:
        try:
            wanted = {**shared, **job.own(capture)}
            found = job.found(capture, wanted)
        except (CutisError, OSError) as error:
            outcomes.append(Estimated(capture.face, failure=str(in_one_line(error))))
            continue
        if found.same and not job.again:
            outcomes.append(Estimated(capture.face, found.report, there=True))
        elif found.complete and found.asked and not job.again:
            flags = ", ".join(FLAGS.get(name, f"--{name}") for name in found.asked)
            outcomes.append(Estimated(capture.face, failure=(
                f"{job.stem(capture)}.skin.exr is there, made with other flags ({flags}); give "
                "another folder with -o, or --again to replace it"
            )))  # fmt: skip
        else:
            opened.todo[capture] = wanted
            opened.changed[capture] = found.content if found.complete else ()
    return outcomes, opened


def _survey(opened: _Open, progress: Progress) -> Surveyed:
    return opened.job.survey(progress)


def _estimate(item: tuple[_Open, CaptureFiles, Surveyed], progress: Progress) -> Report:
    """The report of a capture; its files are those that were meant, wherever this runs."""
    opened, capture, known = item
    job, asked = opened.job, opened.todo[capture]
    own = job.own(capture)
    if any(asked[name] != one for name, one in own.items()):
        raise CutisError(
            f"{capture.face}: the worker sees other files under these names than the one who sent "
            "it; give all of them the same files"
        )
    done = job.estimate(capture, known, asked, progress)
    assert done.report is not None
    return done.report


def _arrived(opened: _Open, capture: CaptureFiles, report: Report) -> Estimated:
    """The outcome of a capture, looked for where it was to be."""
    found = look(opened.job.report_file(capture), opened.todo[capture])
    if not found.same:
        return Estimated(capture.face, failure=(
            f"{opened.job.report_file(capture)}: the results are not where they were to be; the "
            "worker writes elsewhere, or another run replaced them"
        ))  # fmt: skip
    return Estimated(capture.face, report, changed=opened.changed[capture])
