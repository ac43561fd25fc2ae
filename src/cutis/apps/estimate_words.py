"""What `cutis estimate` says of its results."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cutis.apps.console import out, print_statistics
from cutis.report import summary

if TYPE_CHECKING:
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.outcome import Estimated
    from cutis.report import Report


def say(
    sets: "Sequence[EstimateJob]", found: "Sequence[Estimated]", doubts: Sequence[str] = ()
) -> None:
    """Prints what was found: all of one capture, a line for each of many; `doubts` come first."""
    from cutis.jobs.inputs import gaps, odd_ones

    for doubt in doubts:
        out.say(doubt)

    for job in sets:
        captures = tuple(one.face for one in job.captures)
        for name in gaps(captures):
            out.say(f"{name} is missing between other tiles of its row")
        for line in odd_ones(captures, job.colorspace):
            out.say(line)
    alone = len(sets) == 1 and len(sets[0].captures) == 1
    for outcome in found:
        if outcome.changed:
            out.say(f"{outcome.face.name}: made again, {', '.join(outcome.changed)} changed")
    if not alone:
        _say_many(sets, found)
    elif found and found[0].report is not None:
        stem = sets[0].stem(sets[0].captures[0])
        if found[0].there:
            out.say(f"{stem}.skin.exr was there already, made the same way; --again makes it anew")
        else:
            out.say(f"wrote {stem}.skin.exr and what belongs to it")
        mask = sets[0].captures[0].mask
        say_one(found[0].report, found[0].face, Path(f"{stem}.skin.exr"), mask, sets[0].output)


def _say_many(sets: "Sequence[EstimateJob]", found: "Sequence[Estimated]") -> None:
    new = [outcome for outcome in found if outcome.report is not None and not outcome.there]
    for outcome in new:
        assert outcome.report is not None
        out.say(f"{outcome.face.name}: {summary.line(outcome.report)}")
        for note in outcome.report.notes:
            out.say(f"{outcome.face.name}: {note}")
    skipped = sum(outcome.there for outcome in found)
    left = f", {skipped} were there already" if skipped else ""
    total = sum(len(job.captures) for job in sets)
    out.say(f"{len(new)} of {total} estimated into {sets[0].output}{left}")


def say_one(
    report: "Report", face: Path, maps: Path, mask: Path | None = None, output: Path | None = None
) -> None:
    """Prints what was found in one capture: its files, and where its results went if known."""
    for line in summary.before(report):
        out.say(line)
    print_statistics(summary.rows(report))
    more = (None if path is None else str(path) for path in (mask, output))
    for line in summary.after(report, str(face), str(maps), *more):
        out.say(line)
