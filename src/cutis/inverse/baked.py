"""An inverse from RGB to skin, baked into a three-dimensional table.

Whatever computes it, an inverse from RGB is a function of three numbers. A table holds it as
uniform cubic B-splines (twice differentiable, so maps are as smooth as the colours) over

    a = G^¼,   b = R / (R + G),   c = B / (B + G),

in which the gamut of skin is compact. Colours beyond the ends of an axis take the end's value.
What is baked: `exact_inverse` of an encoder, `probable_skins` of a prior, and how far to trust
those (`trust.py`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace
from cutis.inverse.fit import fit
from cutis.inverse.network import Perceptron
from cutis.inverse.prior import SkinPrior
from cutis.kernels.splines import through_nodes
from cutis.optics import axes

PRECISION = (3.0, 1.0, 1.0, 3.0, 1.0)
"""Inverse variances of the logits around the estimate of an encoder."""
LANES = 8
"""Values per node in memory: what a vector holds."""
TOLERANCE = 0.01
"""Relative colour error worth one standard deviation of the prior (see `fit.py`)."""
COORDINATES, UNITS, RAW = 0, 1, 2
"""What a look-up gives: coordinates in [0, 1], parameters in their units, the values as baked."""

AXES = axes().astype(np.float32)

Solver = Callable[[NDArray[np.float32]], NDArray[np.floating]]


@dataclass(frozen=True)
class Chart:
    """Ends of a, b and c, just outside an albedo space, and cells between them."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    cells: tuple[int, ...]

    def colours(self) -> NDArray[np.float32]:
        """(nodes, 3) linear sRGB at the nodes, a slowest."""
        ends = zip(self.low, self.high, self.cells, strict=True)
        axes = [np.linspace(low, high, n + 1) for low, high, n in ends]
        a, b, c = np.meshgrid(*axes, indexing="ij")
        green = a**4
        rgb = np.stack([green * b / (1 - b), green, green * c / (1 - c)], axis=-1)
        return rgb.reshape(-1, 3).astype(np.float32)


ALIAGA_CHART = Chart((0.32, 0.49, 0.09), (0.92, 0.93, 0.58), (112, 80, 80))
"""Around the albedo space of `aliaga2022`."""
MEASURED_CHART = Chart((0.25, 0.47, 0.04), (0.92, 0.965, 0.63), (112, 80, 88))
"""Around that of `measured2026`, which is darker and redder at its ends."""


@dataclass(frozen=True, eq=False)
class Baked:
    """B-spline coefficients (a, b, c, 5 to 8), float32, over a chart."""

    coefficients: NDArray[np.float32]
    chart: Chart = ALIAGA_CHART

    def __call__(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) calibrated linear sRGB → (n, 5) network coordinates in [0, 1]."""
        return self._look_up(colours, COORDINATES, 5)

    def skins(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) calibrated linear sRGB → (n, 5) parameters in their units, within their ranges."""
        return self._look_up(colours, UNITS, 5)

    def values(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) calibrated linear sRGB → (n, 5 to 8), what was baked, not clamped."""
        return self._look_up(colours, RAW, self.coefficients.shape[-1])

    def _look_up(self, colours: ArrayLike, form: int, count: int) -> NDArray[np.float32]:
        from cutis.inverse.baked_kernel import look_up

        rgb = np.ascontiguousarray(colours, dtype=np.float32)
        out = np.empty((len(rgb), count), dtype=np.float32)
        low, high = np.array(self.chart.low), np.array(self.chart.high)
        scale = (np.array(self.chart.cells) / (high - low)).astype(np.float32)
        look_up(len(rgb), rgb, self._lanes, low.astype(np.float32), scale, AXES, form, out)
        return out

    @cached_property
    def _lanes(self) -> NDArray[np.float32]:
        """The coefficients in eight lanes, of which the last are 0."""
        padding = [(0, 0)] * 3 + [(0, LANES - self.coefficients.shape[-1])]
        return np.ascontiguousarray(np.pad(self.coefficients, padding))


def exact_inverse(encoder: Perceptron, space: AlbedoSpace) -> Solver:
    """What `encoder` estimates, moved by a fit to the nearest skin that has exactly that colour.

    An encoder trained on skins spread evenly over the albedo space estimates the mean of all skins
    of a colour.
    """
    return lambda colours: fit(space, colours, encoder(colours), np.diag(PRECISION), TOLERANCE)


def probable_skins(prior: SkinPrior, space: AlbedoSpace) -> Solver:
    """The most probable skins under a prior."""
    return lambda colours: prior.skins(space, colours)


def bake(solve: Solver, chart: Chart, progress: Callable[[int, int], None] | None = None) -> Baked:
    """Solves every node of the chart (seconds); `progress(done, total)` is called now and then."""
    colours = chart.colours()
    parts, step = [], -(-len(colours) // 20)
    for start in range(0, len(colours), step):
        parts.append(solve(colours[start : start + step]))
        if progress:
            progress(min(start + step, len(colours)), len(colours))
    nodes = np.concatenate(parts)
    shape = (*(n + 1 for n in chart.cells), nodes.shape[1])
    coefficients = through_nodes(nodes.reshape(shape), 3, "natural")
    return Baked(coefficients.astype(np.float32), chart)


def save_baked(baked: Baked, file: Path) -> None:
    """Writes a baked inverse as .npz, coefficients in steps of 1/65535 of their range.

    Each is stored as its difference to the one before along c, which packs to half the size.
    """
    low, high = float(baked.coefficients.min()), float(baked.coefficients.max())
    steps = np.round((baked.coefficients - low) / (high - low) * 65535).astype(np.uint16)
    changes = np.diff(steps, axis=2, prepend=np.uint16(0))  # modulo 65536, as the sum is
    chart = np.array([baked.chart.low, baked.chart.high])
    np.savez_compressed(file, changes=changes, ends=np.array([low, high]), chart=chart)


def load_baked(file: Path) -> Baked:
    """Reads what `save_baked` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        low, high = stored["ends"]
        steps = np.cumsum(stored["changes"], axis=2, dtype=np.uint16)
        scale = np.float32((high - low) / 65535)
        ends = (
            stored["chart"].tolist() if "chart" in stored else (ALIAGA_CHART.low, ALIAGA_CHART.high)
        )
        cells = tuple(n - 3 for n in steps.shape[:3])
        chart = Chart(tuple(ends[0]), tuple(ends[1]), cells)
        return Baked(np.float32(low) + steps.astype(np.float32) * scale, chart)
