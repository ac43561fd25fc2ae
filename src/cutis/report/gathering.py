"""A report in the making: numbers of an estimate, gathered some rows at a time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cutis.arrays import Coordinates, Floats, Picture, Where
from cutis.colour.difference import LIGHTEST_HAIR, PALEST, to_relative_xyz
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model
from cutis.maps.skin_maps import SkinMaps
from cutis.maps.statistics import Histogram, MapStatistics
from cutis.maps.trust import TrustStatistics
from cutis.optics import NAMES, parameter
from cutis.report.numbers import Bars, CalibrationNumbers, ColourNumbers, MapNumbers, Report
from cutis.textures.texture import bands

GAMUT_DELTA_E = 1.0
"""CIEDE2000 beyond which the model does not explain a texel: it is out of gamut."""


class RunningReport:
    """The numbers of a report in the making: `add` the rows of an estimate from top to bottom."""

    def __init__(self, model: Model, calibration: Calibration, shape: tuple[int, int]) -> None:
        """Of an estimate by a model with a calibration, (H, W) texels in all."""
        self._model, self._calibration, self._shape = model, calibration, shape
        self.statistics, self._trust = MapStatistics(), TrustStatistics()
        self._errors = Histogram(0.0, 100.0)
        self._angles = Histogram(-180.0, 180.0)
        self._tallies = np.zeros(5)  # texels inside, below 0, above 1, out of gamut; squares
        self._smoothness = Smoothness()

    def add(self, skin: SkinMaps) -> None:
        """The next rows, with their capture."""
        for rows in bands(skin.shape):
            self._add(skin.rows(rows))

    def _add(self, skin: SkinMaps) -> None:
        if skin.source is None:
            raise CutisError("a report needs the capture; read it and estimate again")
        from cutis.report.judging_kernel import judge

        inside, rows = skin.mask > 0, skin.shape[0]
        errors, angles = np.empty(skin.shape, np.float32), np.empty(skin.shape, np.float32)
        where, tallies = np.empty(skin.shape, np.bool_), np.empty((rows, 5))
        judge(
            rows, skin.source, skin.model_albedo, inside,
            self._calibration.apply(np.eye(3)).T.copy(), to_relative_xyz(),
            (LIGHTEST_HAIR, PALEST), GAMUT_DELTA_E, where, errors, angles, tallies,
        )  # fmt: skip
        self._tallies += tallies.sum(axis=0)
        self._errors.add(errors[where])
        self._angles.add(angles[where])
        u = skin.coordinates()
        self.statistics.add(u, inside)
        self._trust.add(skin.sigmas, skin.confidence, u, inside)
        self._smoothness.add(u, skin.source, where)

    def finish(self) -> Report:
        """The numbers; see `report`."""
        statistics, how = self.statistics, self._calibration
        masked, below, above = (int(count) for count in self._tallies[:3])
        percentiles, histograms = statistics.percentiles(), statistics.histograms()
        trust, count = self._trust.finish(self._model), self._errors.count
        return Report(
            model=self._model.name,
            size=self._shape,
            masked_texels=masked,
            skin_texels=count,
            below_0=below,
            above_1=above,
            calibration=CalibrationNumbers(
                tuple(round(g, 5) for g in how.gains), how.origin, how.light
            ),
            maps={
                name: known_map(
                    parameter(name).unit, percentiles[name], trust.get(name, {}), histograms[name]
                )
                for name in NAMES
            },
            clamped=statistics.clamped(),
            low_confidence=self._trust.low_confidence(),
            colour=self._colour() if count else None,
            smoothness=self._smoothness.finish() if count else {},
        )

    def _colour(self) -> ColourNumbers:
        count, (beyond, squares) = self._errors.count, self._tallies[3:]
        return ColourNumbers(
            mse=float(squares) / (3 * count),
            delta_e_mean=self._errors.mean(),
            delta_e_p95=self._errors.percentile(0.95),
            out_of_gamut=int(beyond) / count,
            ita_median=self._angles.percentile(0.5),
        )


def known_map(
    unit: str,
    percentiles: Sequence[float],
    trust: Mapping[str, float],
    histogram: Mapping[str, Sequence[float]] | None = None,
) -> MapNumbers:
    """The numbers of a map from what `maps.statistics` and `maps.trust` say of it."""
    low, median, high = percentiles
    bars = None
    if histogram is not None:
        bars = Bars(tuple(histogram["edges"]), tuple(int(n) for n in histogram["counts"]))
    return MapNumbers(
        unit, low, median, high, trust.get("sure_median"), trust.get("sigma"),
        trust.get("informed"), bars,
    )  # fmt: skip


def report(skin: SkinMaps) -> dict[str, Any]:
    """Every number that `cutis estimate` prints, as report.json holds it; needs the capture.

    Colour errors compare the model alone with the calibrated capture, on skin texels: inside the
    mask, L* > 35 and C*ab > 12; without any, `colour` and `smoothness` are left out. `smoothness`
    is the mean difference of neighbouring texels of a map, in network coordinates, over that of
    the capture (mean over R, G, B). `below_0` and `above_1` count texels inside the mask with a
    colour that is no albedo. Percentiles are read from histograms of 65 536 bins and more;
    `clamped` is the share of texels at an end of a map's range, `histogram` 64 bars for people.
    Where the model knows σ, `low_confidence` is the share of the mask with a confidence below 0.5,
    and over the rest maps have `sigma` and `sure_median`, the medians of σ and of the map, and
    `informed`: 1 − σ / σ of the prior in network coordinates, 1 where all is known and 0 where the
    colour said nothing.
    """
    running = RunningReport(skin.model, skin.calibration, skin.shape)
    running.add(skin)
    return running.finish().as_dict()


class Smoothness:
    """Mean neighbour difference of each map over that of the capture, over chosen texels."""

    def __init__(self) -> None:
        self._maps, self._colour = np.zeros(5), np.zeros(3)
        self._last: tuple[Where, Floats, Floats] | None
        self._last = None

    def add(self, u: Coordinates, source: Picture, where: Where) -> None:
        """The next rows: coordinates (h, W, 5), capture (h, W, 3), texels (h, W) that count."""
        from cutis.kernels.statistics_kernel import differences

        for values, total in ((u, self._maps), (source, self._colour)):
            sums = np.empty((len(values), values.shape[2]))
            differences(len(sums), np.ascontiguousarray(values), where, sums)
            total += sums.sum(axis=0)
        if self._last is not None:  # from the last row of what came before to the first of this
            both = self._last[0] & where[0]
            self._maps += np.abs(u[0] - self._last[1])[both].sum(axis=0, dtype=np.float64)
            self._colour += np.abs(source[0] - self._last[2])[both].sum(axis=0, dtype=np.float64)
        self._last = where[-1].copy(), u[-1].copy(), source[-1].copy()

    def finish(self) -> dict[str, float]:
        """The ratio for each map; 0 where the capture is flat."""
        base = float(self._colour.mean())
        return {
            name: float(m / base) if base else 0.0
            for name, m in zip(NAMES, self._maps, strict=True)
        }
