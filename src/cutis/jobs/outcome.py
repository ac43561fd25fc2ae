"""What goes into an estimate, and what comes of it."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cutis.jobs.job import Told
from cutis.report import Report

Asked = dict[str, Told]
"""What a result depends on, by name."""


@dataclass(frozen=True)
class CaptureFiles:
    """A capture with the mask and the picture of regions that belong to it."""

    face: Path
    mask: Path | None = None
    regions: Path | None = None


@dataclass(frozen=True)
class Estimated:
    """What came of a capture: its report, or in one line why there is none.

    `there` says that the result was there already, made of the same in the same way; `changed`
    names the contents for whose sake it was made again.
    """

    face: Path
    report: Report | None = None
    failure: str | None = None
    there: bool = False
    changed: tuple[str, ...] = ()
    pictures: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)
