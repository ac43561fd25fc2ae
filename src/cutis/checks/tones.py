"""Tones that were cut off: clipped at the top, crushed at the bottom."""

from collections.abc import Iterator

from cutis.checks.evidence import Evidence
from cutis.checks.finding import Finding, graded
from cutis.checks.thresholds import Limits
from cutis.report.words import percent


def clipped(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Texels at the highest code, or above one."""
    found = seen.gathered.tallies
    if not found.inside:
        return
    share = max(found.top, found.above) / found.inside
    level = graded(share, limits["note"], limits["finding"])
    if level is not None:
        what = "are above one" if found.above > found.top else "are at the highest code"
        yield Finding(
            "clipped", level, f"{percent(share)} of the texels {what} in a channel.",
            "No skin is white: expose darker, or mask highlights out.",
            {"share": share, "highest": found.highest, "limit": limits["finding"]},
        )  # fmt: skip


def crushed(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Texels at zero, or below."""
    found = seen.gathered.tallies
    if not found.inside:
        return
    share = max(found.bottom, found.below) / found.inside
    level = graded(share, limits["note"], limits["finding"])
    if level is not None:
        what = "are below zero" if found.below > found.bottom else "are zero"
        yield Finding(
            "crushed", level, f"{percent(share)} of the texels {what} in a channel.",
            "No skin is black: mask what is none, or lift the shadows from the raw picture.",
            {"share": share, "lowest": found.lowest, "limit": limits["finding"]},
        )  # fmt: skip
