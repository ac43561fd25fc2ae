"""Colour scales of maps: which value has which place, and which values are written beside it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutis.arrays import Floats
from cutis.report.numbers import Bars

TAILS = 0.005
"""Share of texels beyond each end of a colour scale, at most."""


@dataclass(frozen=True)
class Scale:
    """A colour scale from `low` to `high`, even in the `root`-th root of the values."""

    low: float
    high: float
    root: int = 1

    def place(self, values: ArrayLike) -> Floats:
        """Values → where they lie on the scale, [0, 1]; NaN stays."""
        low, high = self._rooted(self.low), self._rooted(self.high)
        return (self._rooted(np.clip(values, self.low, self.high)) - low) / (high - low)

    def value(self, place: float) -> float:
        """The value at a place of the scale."""
        low, high = (float(self._rooted(end)) for end in (self.low, self.high))
        return float((low + place * (high - low)) ** self.root)

    def ticks(self, most: int) -> list[float]:
        """Round values inside the scale for people to read, some `most` at best.

        Multiples of one step where the scale is even; else those of 1, 2, 3, 5 × 10ⁿ that have
        room for their text, which is as wide as 1 / `most`.
        """
        if self.root == 1:
            return _multiples(self.low, self.high, most)
        digits = range(math.floor(math.log10(max(self.low, self.high * 1e-6))),
                       math.floor(math.log10(self.high)) + 1)  # fmt: skip
        found = [] if self.low > 0 else [0.0]
        for factors in ((1,), (3,), (2, 5), (1.5, 4, 7)):
            for value in (f * 10.0**n for n in reversed(digits) for f in factors):
                far = (abs(self.place(value) - self.place(old)) >= 1 / most for old in found)
                if self.low <= value <= self.high and all(far):
                    found.append(value)
        # what spans less than a factor of two has no such values
        return sorted(found) if len(found) > 1 else _multiples(self.low, self.high, most)

    def _rooted(self, values: ArrayLike) -> Floats:
        x = np.asarray(values)
        x = x if x.dtype == np.float32 else x.astype(np.float64)
        if self.root == 3:
            return np.cbrt(x)
        return np.sqrt(np.sqrt(x)) if self.root == 4 else x ** (1 / self.root)


def tick_text(value: float) -> str:
    """A round value as text."""
    text = f"{value:.6f}".rstrip("0").rstrip(".") if value < 1e4 else f"{value:g}"
    return text.replace("-", "−") if abs(value) >= 1e-6 or not value else f"{value:g}"


def scale_of(bars: Bars, root: int = 1) -> Scale:
    """A scale over all bars but the emptiest at both ends, TAILS of the texels each."""
    below = np.cumsum(bars.counts)
    if not below.size or below[-1] == 0:
        return Scale(0.0, 1.0, root)
    first = int(np.searchsorted(below, TAILS * below[-1], side="right"))
    last = int(np.searchsorted(below, (1 - TAILS) * below[-1]))
    low, high = (max(float(e), 0.0) for e in (bars.edges[first], bars.edges[last + 1]))
    return Scale(low, max(high, low + 1e-6 * max(low, 1.0)), root)


def bars_of(values: Floats, bins: int = 64) -> Bars:
    """A histogram of the finite among `values`, its outermost thousandths left out."""
    finite = values[np.isfinite(values)]
    ends = np.percentile(finite, [0.1, 99.9]) if finite.size else (0.0, 1.0)
    counts, edges = np.histogram(finite, bins, range=(float(ends[0]), float(ends[1])))
    return Bars(tuple(float(e) for e in edges), tuple(int(c) for c in counts))


def _multiples(low: float, high: float, most: int) -> list[float]:
    rough = max((high - low) / most, 1e-12)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(f * power for f in (1, 2, 2.5, 5, 10) if f * power >= rough * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)] or [low]
