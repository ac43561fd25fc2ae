"""Edits of skin maps as values: multiply, offset, set, or hold one parameter within ends."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.optics import parameter

Amount = float | NDArray[np.float32]
"""A number, or an array of the maps' shape: a number for each texel."""
OPERATIONS: dict[str, Callable[[NDArray[np.float32], Amount], NDArray[np.float32]]] = {
    "multiply": lambda values, amount: values * np.float32(amount),
    "offset": lambda values, amount: values + np.float32(amount),
    "set": lambda values, amount: np.broadcast_to(np.float32(amount), values.shape).copy(),
    "floor": lambda values, amount: np.maximum(values, np.float32(amount)),
    "ceiling": lambda values, amount: np.minimum(values, np.float32(amount)),
}
WHERE = ("everywhere", "patches")


@dataclass(frozen=True)
class Edit:
    """One change of one parameter: `operation` is multiply, offset, set, floor or ceiling.

    `where` is "everywhere" or "patches", irregular patches over about a third of the skin
    (vitiligo); a painted mask can narrow both. `amount` is in the parameter's unit except for
    multiply: a number, or an array (H, W) with one for each texel. Raises CutisError for unknown
    names, amounts that are not finite, negative factors, and a number to set, floor or ceiling,
    that is out of range; the values of an array are clamped, since maps are 0 without skin.
    """

    parameter: str
    operation: str
    amount: Amount
    where: str = "everywhere"

    def __post_init__(self) -> None:
        known = parameter(self.parameter)
        if self.operation not in OPERATIONS:
            raise CutisError(f"unknown operation {self.operation!r}; use {', '.join(OPERATIONS)}")
        if self.where not in WHERE:
            raise CutisError(f"unknown place {self.where!r}; use {', '.join(WHERE)}")
        amount = self._checked()
        bad = not np.isfinite(amount).all() or (self.operation == "multiply" and amount.min() < 0)
        if bad:
            raise CutisError(f"cannot {self.operation} {self.parameter} by {self._told('g')}")
        if self.operation in ("set", "floor", "ceiling") and amount.ndim == 0:
            known.check(float(amount))

    def _checked(self) -> NDArray[np.floating]:
        """The amount as an array; an array of another kind becomes one that cannot be changed."""
        if np.ndim(self.amount) == 0:
            return np.asarray(self.amount, dtype=np.float64)
        array = np.array(self.amount, dtype=np.float32)
        if array.ndim != 2 or not array.size:
            raise CutisError(
                f"{self.parameter}: an amount is a number or an array of the maps' (H, W), not of "
                f"shape {array.shape}"
            )
        array.flags.writeable = False
        object.__setattr__(self, "amount", array)
        return array

    def _told(self, how: str) -> str:
        return "a map" if isinstance(self.amount, np.ndarray) else f"{self.amount:{how}}"

    def __str__(self) -> str:
        sign = {
            "multiply": f"x{self._told('g')}", "offset": self._told("+g"),
            "floor": f"at least {self._told('g')}", "ceiling": f"at most {self._told('g')}",
        }  # fmt: skip
        text = f"{self.parameter} {sign.get(self.operation, self._told('g'))}"
        return text if self.where == "everywhere" else f"{text} in {self.where}"

    def rows(self, rows: slice) -> "Edit":
        """The same for some rows of the maps."""
        whole = self.amount
        return replace(self, amount=whole[rows]) if isinstance(whole, np.ndarray) else self

    def of(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        """Edited copy of values of a map, clamped to range; any shape where the amount is one."""
        known = parameter(self.parameter)
        edited = OPERATIONS[self.operation](values, self.amount)
        return np.clip(edited, np.float32(known.low), np.float32(known.high))

    def __call__(
        self, values: NDArray[np.float32], weight: NDArray[np.float32] | None = None
    ) -> tuple[NDArray[np.float32], int]:
        """Edited copy of a map and the number of its values that had to be clamped to range.

        `weight` (same shape, 0–1) blends between the old value and the new one; where the result
        equals the old value it is the old value, bit for bit.
        """
        known = parameter(self.parameter)
        if isinstance(self.amount, np.ndarray) and self.amount.shape != values.shape:
            raise CutisError(
                f"the amount of {self.parameter} is {self.amount.shape}, the maps are "
                f"{values.shape}"
            )
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

        A factor scales σ, a set value is known: σ is 0; what else is done leaves it. A weight w
        takes that much of the change, as of the value. No σ is wider than the range; where a value
        was clamped to an end σ stays, since the skin beyond that end is no better known.
        """
        slopes: dict[str, Amount] = {"multiply": self.amount, "set": 0.0}
        known = parameter(self.parameter)
        slope = np.asarray(slopes.get(self.operation, 1.0), np.float64)
        scale = np.float32(slope) if weight is None else 1 + weight * np.float32(slope - 1)
        return np.minimum(sigma * scale, np.float32(known.high - known.low))


SIGNS = {"x": "multiply", "X": "multiply", "×": "multiply", "*": "multiply", "+": "offset",
         "-": "offset", "=": "set"}  # fmt: skip
"""What the first character of an edit says; without one, the value is set."""


def parse_amount(text: str) -> tuple[str, float]:
    """Operation and amount of `x1.4`, `+0.1`, `-0.1`, `0.02` or `=0.02`; ValueError for others."""
    text = text.strip()
    operation = SIGNS.get(text[:1], "set")
    number = text if text[:1] in "+-" or text[:1] not in SIGNS else text[1:]
    return operation, float(number)


def parse_edit(name: str, text: str) -> Edit:
    """`x1.4` → multiply, `+0.1` and `-0.1` → offset, `0.02` → set; CutisError for anything else."""
    try:
        operation, amount = parse_amount(text)
    except ValueError:
        raise CutisError(
            f"--{name} takes a value (0.02), a factor (x1.5) or an offset (+0.1), not "
            f"{text.strip()!r}"
        ) from None
    return Edit(name, operation, amount)
