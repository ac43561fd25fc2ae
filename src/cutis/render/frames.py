"""Pictures of a sequence: a turntable, or an edit that grows from frame to frame."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cutis.errors import CutisError
from cutis.maps import Edit, Edits
from cutis.optics import parameter

RANGE = re.compile(r"^([x×*+=]?)(-?[0-9.eE+-]+?)\.\.(-?[0-9.eE+-]+)$")
MOST = 10_000
"""Pictures of a sequence."""
OPERATIONS = {"": "multiply", "x": "multiply", "×": "multiply", "*": "multiply", "+": "offset",
              "=": "set"}  # fmt: skip


@dataclass(frozen=True)
class Frame:
    """One picture of a sequence: its number, degrees that the head is turned, edits, a label."""

    number: int
    turn: float = 0.0
    edits: Edits = ()
    label: str = ""


def turntable(count: int) -> list[Frame]:
    """`count` views once around, the first from the front."""
    _checked(count)
    turns = [360.0 * k / count for k in range(count)]
    return [Frame(k + 1, turn, label=f"{turn:.0f}°") for k, turn in enumerate(turns)]


def edit_sweep(name: str, text: str, count: int) -> list[Frame]:
    """`count` steps of an edit of the parameter `name`, from one end of a range to the other.

    `text` is `0.5..3` or `x0.5..3` for factors, in equal ratios where both are above 0; `+0..0.1`
    for offsets and `=0.01..0.3` for values, in equal steps. Raises CutisError for anything else.
    """
    _checked(count)
    parameter(name)
    found = RANGE.match(text.replace(" ", ""))
    try:
        if found is None:
            raise ValueError
        first, last = float(found[2]), float(found[3])
        if not np.isfinite([first, last]).all():
            raise ValueError
    except ValueError:
        raise CutisError(
            f"--edit-sweep {name} {text!r}: give factors like 0.5..3, offsets like +0..0.1 or "
            "values like =0.01..0.3"
        ) from None
    operation = OPERATIONS[found[1]]
    ratios = operation == "multiply" and min(first, last) > 0
    steps = np.geomspace(first, last, count) if ratios else np.linspace(first, last, count)
    edits = (Edit(name, operation, float(f"{value:.6g}")) for value in steps)
    return [Frame(k + 1, edits=(edit,), label=str(edit)) for k, edit in enumerate(edits)]


def file_names(frames: list[Frame], stem: str, suffix: str) -> Iterator[tuple[Frame, str]]:
    """Each frame with the name of its file: STEM.0001.png, STEM.0002.png, …"""
    for frame in frames:
        yield frame, f"{stem}.{frame.number:04d}{suffix}"


def _checked(count: int) -> None:
    if not 2 <= count <= MOST:
        raise CutisError(f"a sequence has 2 to {MOST} pictures, not {count}")
