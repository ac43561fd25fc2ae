"""Edits of skin maps as values: multiply, offset, set, blend one parameter."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.optics import parameter

OPERATIONS: dict[str, Callable[[NDArray[np.float32], float], NDArray[np.float32]]] = {
    "multiply": lambda values, amount: values * np.float32(amount),
    "offset": lambda values, amount: values + np.float32(amount),
    "set": lambda values, amount: np.full_like(values, amount),
}
WHERE = ("everywhere", "patches")


@dataclass(frozen=True)
class Edit:
    """One change of one parameter: `operation` is multiply, offset or set.

    `where` is "everywhere" or "patches", irregular patches over about a third of the skin
    (vitiligo); a painted mask can narrow both. `amount` is in the parameter's unit for offset
    and set.
    """

    parameter: str
    operation: str
    amount: float
    where: str = "everywhere"

    def __post_init__(self) -> None:
        known = parameter(self.parameter)
        if self.operation not in OPERATIONS:
            raise CutisError(f"unknown operation {self.operation!r}; use {', '.join(OPERATIONS)}")
        if self.where not in WHERE:
            raise CutisError(f"unknown place {self.where!r}; use {', '.join(WHERE)}")
        if not np.isfinite(self.amount) or (self.operation == "multiply" and self.amount < 0):
            raise CutisError(f"cannot {self.operation} {self.parameter} by {self.amount:g}")
        if self.operation == "set":
            known.check(self.amount)

    def __str__(self) -> str:
        sign = {"multiply": f"x{self.amount:g}", "offset": f"{self.amount:+g}"}
        text = f"{self.parameter} {sign.get(self.operation, f'{self.amount:g}')}"
        return text if self.where == "everywhere" else f"{text} in {self.where}"

    def __call__(
        self, values: NDArray[np.float32], weight: NDArray[np.float32] | None = None
    ) -> tuple[NDArray[np.float32], int]:
        """Edited copy of a map and the number of its values that had to be clamped to range.

        `weight` (same shape, 0–1) blends between the old value and the new one; where the result
        equals the old value it is the old value, bit for bit.
        """
        known = parameter(self.parameter)
        edited = OPERATIONS[self.operation](values, self.amount)
        low, high = np.float32(known.low), np.float32(known.high)
        limited = np.clip(edited, low, high)
        if weight is None:
            return limited, int(np.count_nonzero(limited != edited))
        clamped = int(np.count_nonzero((limited != edited) & (weight > 0)))
        partial = (weight > 0) & (weight < 1) & (limited != values)
        result = np.where(weight > 0, limited, values)
        old = values[partial]
        mixed = old + weight[partial] * (limited[partial] - old)
        result[partial] = np.clip(mixed, low, high)  # rounding may overshoot by a last digit
        return result, clamped

    def sigma(
        self, sigma: NDArray[np.float32], weight: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """What the edit makes of a map's standard deviations, in the same units and shape.

        A factor scales σ, an offset leaves it, a set value is known: σ is 0. A weight w takes that
        much of the change, as of the value. No σ is wider than the range; where a value was clamped
        to an end σ stays, since the skin beyond that end is no better known.
        """
        slope = {"multiply": self.amount, "offset": 1.0, "set": 0.0}[self.operation]
        known = parameter(self.parameter)
        scale = np.float32(slope) if weight is None else 1 + weight * np.float32(slope - 1)
        return np.minimum(sigma * scale, np.float32(known.high - known.low))


def parse_edit(name: str, text: str) -> Edit:
    """`x1.4` → multiply, `+0.1` and `-0.1` → offset, `0.02` → set; CutisError for anything else."""
    text = text.strip()
    operation, number = "set", text
    if text[:1] in ("x", "X", "×", "*"):
        operation, number = "multiply", text[1:]
    elif text[:1] in ("+", "-"):
        operation = "offset"
    try:
        amount = float(number)
    except ValueError:
        raise CutisError(
            f"--{name} takes a value (0.02), a factor (x1.5) or an offset (+0.1), not {text!r}"
        ) from None
    return Edit(name, operation, amount)
