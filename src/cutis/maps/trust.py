"""How far the maps of an estimate can be trusted, in numbers.

σ is the standard deviation of a parameter given the colour of its texel, confidence how likely
that colour is one of skin. What σ is worth is seen against what was known before any colour was
seen: a map is *informed* by 1 − σ / σ of the prior, both in network coordinates. Where a model
has no prior, any value of the range was as likely as another.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cutis.inverse.model import Model
from cutis.maps.statistics import BINS, quantile
from cutis.optics import NAMES, PARAMETERS, Parameter, axes

SIGMA = ".sigma"
"""After the name of a map in EXR channels: its standard deviation."""
CONFIDENCE = "confidence"
"""The channel of confidence."""
LOW = 0.5
"""Confidence below which a colour is taken for one of something else."""
EVEN = 12**-0.5
"""Standard deviation of a network coordinate of which nothing is known."""


def stored_sigma(values: NDArray[np.float32], known: Parameter) -> NDArray[np.float32]:
    """A σ from a file: what is not known, or more than the width of the range, is that width."""
    width = np.float32(known.high - known.low)
    return np.clip(np.nan_to_num(values, nan=float(width)), np.float32(0), width)


def prior_sigma(model: Model | None) -> tuple[float, ...]:
    """Standard deviations of the five network coordinates before a colour was seen."""
    known = None if model is None else model.prior_sigma
    return (EVEN,) * len(NAMES) if known is None else known


class TrustStatistics:
    """Median σ of each map over confident texels, and how many are not: filled band by band."""

    def __init__(self) -> None:
        self._names: set[str] = set()
        self._even = np.zeros((len(NAMES), BINS), dtype=np.int64)
        self._share = np.zeros((len(NAMES), BINS), dtype=np.int64)
        self._values = np.zeros((len(NAMES), BINS), dtype=np.int64)
        self._inside = self._unsure = 0

    def add(
        self,
        sigmas: Mapping[str, NDArray[np.float32]],
        confidence: NDArray[np.float32] | None,
        u: NDArray[np.float32],
        inside: NDArray[np.bool_],
    ) -> None:
        """The next rows (h, W): σ by name, confidence, coordinates (h, W, 5), where the mask is."""
        from cutis.kernels.statistics_kernel import count, count_spread

        if not sigmas:
            return
        self._names |= set(sigmas)
        sure = inside if confidence is None else inside & (confidence >= LOW)
        self._inside += int(np.count_nonzero(inside))
        self._unsure += int(np.count_nonzero(inside)) - int(np.count_nonzero(sure))
        nothing = np.zeros(inside.shape, np.float32)
        spreads = tuple(np.asarray(sigmas.get(name, nothing)) for name in NAMES)
        count_spread(spreads, u, sure, axes(), self._even, self._share)
        count(u, sure, self._values)

    def low_confidence(self) -> float | None:
        """Share of the texels whose colour is rather not one of skin; None without σ."""
        return self._unsure / self._inside if self._inside else None

    def finish(self, model: Model | None) -> dict[str, dict[str, float]]:
        """For each map with σ its median in the map's unit and how far the map is `informed`.

        `sure_median` is that of the map itself over the same texels, which σ is a share of: hair
        inside a mask has no part in either. Empty where no texel is confident. `model` is None
        where it is not here any more.
        """
        if self._inside == self._unsure:
            return {}
        prior, found = prior_sigma(model), {}
        for i, known in enumerate(PARAMETERS):
            if known.name in self._names:
                share, even = (
                    (quantile(counts[i], 0.5) + 0.5) / BINS for counts in (self._share, self._even)
                )
                middle = (quantile(self._values[i], 0.5) + 0.5) / BINS
                found[known.name] = {
                    "sure_median": float(known.from_coordinate(middle)),
                    "sigma": share * (known.high - known.low),
                    "informed": max(0.0, 1 - even / prior[i]),
                }
        return found
