"""What a check says of a texture."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Level = Literal["finding", "note"]
"""A finding spoils maps, or is no albedo of skin; a note is worth knowing."""


@dataclass(frozen=True)
class Finding:
    """One thing that was found: its `kind`, a sentence, a hint how to go on, its `numbers`.

    `numbers` are what was measured and the threshold that it passed, by name.
    """

    kind: str
    level: Level
    sentence: str
    hint: str = ""
    numbers: Mapping[str, float] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        numbers = {name: round(float(value), 5) for name, value in self.numbers.items()}
        return {
            "kind": self.kind, "level": self.level, "sentence": self.sentence, "hint": self.hint,
            "numbers": numbers,
        }  # fmt: skip


def graded(value: float, note: float, finding: float) -> Level | None:
    """The level of a value that is the worse the larger it is; None below both thresholds."""
    if value >= finding:
        return "finding"
    return "note" if value >= note else None
