"""Distributions of maps that come in pieces: histograms fine enough to read percentiles from."""

import base64
import binascii
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.optics import NAMES, PARAMETERS, axes, from_coordinates

BINS = 1 << 16
"""Bins over the network coordinate of a map: a percentile is found to 1/131072 of its
range."""
SHOWN = 64
"""Bars of the histogram that people see."""


def coordinates(
    maps: Sequence[NDArray[np.float32]], where: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Network coordinates (h, W, 5) of the five maps (h, W) where `where` is True, else 0."""
    from cutis.kernels.statistics_kernel import coordinates as fill

    out = np.empty((*where.shape, 5), np.float32)
    fill(len(where), tuple(maps), where, axes(), out)
    return out


class Histogram:
    """Counts of numbers in BINS even bins from `low` to `high`; those beyond count as the ends."""

    def __init__(self, low: float, high: float) -> None:
        self._low, self._high = low, high
        self._counts = np.zeros(BINS, dtype=np.int64)
        self._sum = 0.0

    @property
    def count(self) -> int:
        """How many numbers came."""
        return int(self._counts.sum())

    def add(self, values: NDArray[np.floating]) -> None:
        """Counts values (n,)."""
        scale = BINS / (self._high - self._low)
        places = np.clip(((values - self._low) * scale).astype(np.int64), 0, BINS - 1)
        self._counts += np.bincount(places, minlength=BINS)
        self._sum += float(values.sum(dtype=np.float64))

    def mean(self) -> float:
        """Their mean, exactly."""
        return self._sum / self.count

    def percentile(self, share: float) -> float:
        """The value below which this share of them lies, to a bin's width."""
        place = quantile(self._counts, share)
        return self._low + (place + 0.5) / BINS * (self._high - self._low)


def quantile(counts: NDArray[np.int64], share: float) -> int:
    """The first bin up to which at least `share` of all lie."""
    total = np.cumsum(counts)
    return min(int(np.searchsorted(total, share * total[-1])), len(counts) - 1)


SHARES = np.linspace(0, 1, 1001)
"""Of the texels: below the k-th value that is kept of a map lie k thousandths of them."""


@dataclass(frozen=True, eq=False)
class Quantiles:
    """Where the values of the five maps of a face lie, as it is kept with the maps.

    `bins` (5, 1001), uint16: of BINS over a map's network coordinate, those up to which SHARES of
    `count` texels lie.
    """

    count: int
    bins: NDArray[np.uint16]

    def percentile(self, name: str, share: float) -> float:
        """The value of a map, in its unit, below which a share in [0, 1] of the texels lies."""
        known = PARAMETERS[NAMES.index(name)]
        place = np.interp(share, SHARES, self.bins[NAMES.index(name)].astype(np.float64))
        return float(known.from_coordinate((place + 0.5) / BINS))

    @classmethod
    def together(cls, parts: Sequence["Quantiles"]) -> "Quantiles":
        """Of the texels of all parts; CutisError where there are none."""
        parts = [part for part in parts if part.count]
        if not parts:
            raise CutisError("there is no skin to take statistics of: the mask is empty")
        if len(parts) == 1:
            return parts[0]
        total = sum(part.count for part in parts)
        joined = np.empty_like(parts[0].bins)
        for row in range(len(NAMES)):
            nodes = np.unique(np.concatenate([part.bins[row] for part in parts]))
            share = np.zeros(len(nodes))
            for part in parts:
                own, last = np.unique(part.bins[row][::-1], return_index=True)
                below = SHARES[len(SHARES) - 1 - last]
                share += part.count / total * np.interp(nodes, own, below, left=0.0)
            joined[row] = np.rint(np.interp(SHARES, share, nodes))
        return cls(total, joined)

    def text(self) -> str:
        """As headers hold it, always of one length."""
        stored = self.bins.astype("<u2").tobytes()
        return f"{self.count:016x}{base64.b64encode(stored).decode()}"

    @classmethod
    def of_text(cls, text: str) -> "Quantiles":
        """What `text` wrote; ValueError for anything else."""
        try:
            stored = np.frombuffer(base64.b64decode(text[16:], validate=True), dtype="<u2")
        except binascii.Error as error:
            raise ValueError("no base64") from error
        bins = stored.reshape(len(NAMES), len(SHARES)).astype(np.uint16)
        if (np.diff(bins.astype(int), axis=1) < 0).any():
            raise ValueError("quantiles rise")
        return cls(int(text[:16], 16), bins)


TEXT = 16 + 4 * -(-2 * len(NAMES) * len(SHARES) // 3)
"""Characters of `Quantiles.text`."""


class MapStatistics:
    """Histograms of the five maps, even in network coordinates, filled band by band."""

    def __init__(self) -> None:
        self.counts = np.zeros((len(NAMES), BINS), dtype=np.int64)

    def add(self, u: NDArray[np.float32], where: NDArray[np.bool_]) -> None:
        """Counts coordinates (h, W, 5) where `where` (h, W) is True."""
        from cutis.kernels.statistics_kernel import count

        count(u, where, self.counts)

    def percentiles(self, shares: Sequence[float] = (0.05, 0.5, 0.95)) -> dict[str, list[float]]:
        """Values of each map, in its unit, below which these shares of the texels lie."""
        u = np.zeros((len(shares), len(NAMES)))
        for i, counts in enumerate(self.counts):
            u[:, i] = [(quantile(counts, share) + 0.5) / BINS for share in shares]
        found = from_coordinates(u)
        return {name: [float(v) for v in found[:, i]] for i, name in enumerate(NAMES)}

    def quantiles(self) -> "Quantiles":
        """What is kept of them with the maps."""
        bins = np.empty((len(NAMES), len(SHARES)), dtype=np.uint16)
        for row, counts in enumerate(self.counts):
            total = np.cumsum(counts)
            bins[row] = np.minimum(np.searchsorted(total, SHARES * total[-1]), BINS - 1)
        return Quantiles(int(self.counts[0].sum()), bins)

    def clamped(self) -> dict[str, float]:
        """Share of the texels at an end of a map's range."""
        ends = self.counts[:, 0] + self.counts[:, -1]
        totals = np.maximum(self.counts.sum(axis=1), 1)
        return {name: float(ends[i] / totals[i]) for i, name in enumerate(NAMES)}

    def histograms(self) -> dict[str, dict[str, list[float] | list[int]]]:
        """SHOWN bars for each map between its 0.1th and 99.9th percentile: edges and counts.

        Bars are even in the network coordinate; edges are in the map's unit. What lies beyond the
        ends is not counted.
        """
        result: dict[str, dict[str, list[float] | list[int]]] = {}
        for i, known in enumerate(PARAMETERS):
            first, last = (quantile(self.counts[i], share) for share in (0.001, 0.999))
            width = -(-(last + 1 - first) // SHOWN)
            first = max(0, min(first, BINS - SHOWN * width))
            bars = np.zeros(SHOWN * width, dtype=np.int64)
            inside = self.counts[i][first : first + SHOWN * width]
            bars[: len(inside)] = inside
            edges = known.from_coordinate((first + width * np.arange(SHOWN + 1)) / BINS)
            result[known.name] = {
                "edges": [float(f"{edge:.6g}") for edge in edges],
                "counts": [int(count) for count in bars.reshape(SHOWN, width).sum(axis=1)],
            }
        return result
