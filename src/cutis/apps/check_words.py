"""What `cutis check` says of textures: a line for each, and one for each finding."""

import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from cutis.apps.console import err, out

if TYPE_CHECKING:
    from cutis.checks.tone import Tone
    from cutis.jobs.check import Checked

NOT_CHECKED = 2
"""Exit code where something could not be checked."""


def say(found: "Sequence[Checked]", notes: Sequence[str] = ()) -> None:
    """Prints all; what could not be checked goes to stderr."""
    for note in notes:
        out.say(note)
    for one in found:
        if one.failure is not None:
            named = one.face.name in one.failure
            err.say(f"cutis: {one.failure if named else f'{one.face}: {one.failure}'}")
            continue
        for line in lines(one):
            out.say(line)


def lines(one: "Checked") -> Iterator[str]:
    """A texture in a line, then its findings and notes."""
    counts = [
        f"{number} {level}{'s' if number > 1 else ''}"
        for level in ("finding", "note") if (number := one.count(level))
    ]  # fmt: skip
    tone = f"; {tone_words(one.tone)}" if one.tone is not None else ""
    yield f"{one.face}: {', '.join(counts) or 'clean'}{tone}"
    for finding in one.findings:
        yield f"  {finding.level} {finding.kind}: {finding.sentence} {finding.hint}".rstrip()
    for path in one.mended:
        yield f"  wrote {path}"


def tone_words(tone: "Tone") -> str:
    """ITA° and Monk tone with their spread."""
    low, middle, high = (f"{angle:.0f}°".replace("-", "−") for angle in tone.ita)
    dark, usual, light = tone.monk
    spread = f" ({light} to {dark})" if light != dark else ""
    return f"ITA {middle} ({low} to {high}), Monk {usual}{spread}"


def print_json(found: "Sequence[Checked]") -> None:
    """Prints all as one JSON list, on stdout and nothing else there."""
    print(json.dumps([as_dict(one) for one in found], indent=2))


def as_dict(one: "Checked") -> dict[str, object]:
    """One texture as plain data."""
    told: dict[str, object] = {"file": str(one.face)}
    if one.failure is not None:
        return {**told, "failure": one.failure}
    told["findings"] = [finding.as_dict() for finding in one.findings]
    if one.tone is not None:
        told["ita"] = dict(zip(("p5", "median", "p95"), one.tone.ita, strict=True))
        told["monk"] = dict(zip(("p5", "median", "p95"), one.tone.monk, strict=True))
    if one.mended:
        told["fixed"] = [str(path) for path in one.mended]
    return told
