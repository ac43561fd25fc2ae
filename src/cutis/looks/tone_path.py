"""What measured skin is like from light people to dark ones: one path for each place of a body.

The tables of `data/tones` go over the ITA° of the person's face (`studies.build_tones`), in log
linear sRGB under D65. Whoever asks beyond their ends gets the line that goes on there.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cutis.optics.tables import packaged_table

Place = Literal["face", "arm", "hand", "palm"]
Array = NDArray[np.float64]
_PAIRS = ("rr", "gg", "bb", "rg", "rb", "gb")
NEAR = 2.0
"""Degrees over which directions are taken."""


@dataclass(frozen=True, eq=False)
class TonePath:
    """Log RGB `colours` (n, 3) at even steps of ITA° `tones` (n,), and what skin varies by there.

    `between` and `within` (n, 3, 3) are covariances of log RGB between persons of a tone and within
    a face; `spread` (n,) the standard deviation of ITA° within a face.
    """

    tones: Array
    colours: Array
    between: Array
    within: Array
    spread: Array

    @cached_property
    def step(self) -> float:
        """Degrees from one row to the next."""
        return float(self.tones[1] - self.tones[0])

    def at(self, values: Array, tone: float) -> Array:
        """What `values`, one of the above, are at a tone."""
        place = float(np.clip((tone - self.tones[0]) / self.step, 0, len(self.tones) - 1.001))
        i, share = int(place), place - int(place)
        return np.asarray(values[i] * (1 - share) + values[i + 1] * share)

    def colour(self, tone: float) -> Array:
        """Log RGB (3,)."""
        return self.at(self.colours, tone)

    def direction(self, tone: float) -> Array:
        """Change of log RGB (3,) a degree."""
        return (self.colour(tone + NEAR) - self.colour(tone - NEAR)) / (2 * NEAR)

    def contrast(self, tone: float) -> float:
        """Standard deviation of log RGB within a face, of all three together."""
        return float(np.sqrt(np.trace(self.at(self.within, tone))))

    def aside(self, tone: float) -> Array:
        """Standard deviations (3,) of log RGB within a face that are not along the path."""
        along = self.direction(tone) * float(self.at(self.spread, tone))
        left = np.diag(self.at(self.within, tone)) - along**2
        return np.sqrt(np.maximum(left, 0.04**2))


@cache
def tone_path(place: Place = "face") -> TonePath:
    """The path of a place."""
    table = packaged_table("tones", place)

    def matrices(kind: str) -> Array:
        rr, gg, bb, rg, rb, gb = (table[f"{kind}_{pair}"] for pair in _PAIRS)
        rows = [[rr, rg, rb], [rg, gg, gb], [rb, gb, bb]]
        return np.moveaxis(np.array(rows), -1, 0)

    colours = np.log(np.stack([table[name] for name in ("red", "green", "blue")], axis=-1))
    return TonePath(table["ita"], colours, matrices("b"), matrices("w"), table["spread"])
