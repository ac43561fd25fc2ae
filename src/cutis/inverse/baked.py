"""The most probable skin of every colour, baked into a three-dimensional table.

Whatever computes it, an inverse from RGB is a function of three numbers. The table holds the fit
of `fit.py` around the estimate of an encoder as uniform cubic B-splines (twice differentiable, so
maps are as smooth as the colours) over

    a = G^¼,   b = R / (R + G),   c = B / (B + G),

in which the gamut of skin is compact. Colours beyond the ends of an axis take the end's value.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import albedo_space
from cutis.inverse.fit import fit
from cutis.inverse.network import Perceptron

LOW = (0.32, 0.49, 0.09)
"""Low ends of a, b, c: just outside the albedo space."""
HIGH = (0.92, 0.93, 0.58)
"""High ends of a, b, c."""
CELLS = (112, 80, 80)
"""Cells of the splines over a, b, c."""

PRECISION = (3.0, 1.0, 1.0, 3.0, 1.0)
"""Inverse variances of the logits around the encoder's estimate."""
LANES = 8
"""Values per node in memory: what a vector holds."""
TOLERANCE = 0.01
"""Relative colour error worth one standard deviation of the prior (see `fit.py`)."""


@dataclass(frozen=True, eq=False)
class Baked:
    """B-spline coefficients (a, b, c, 5), float32, of coordinates u over the chart."""

    coefficients: NDArray[np.float32]

    def __call__(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) calibrated linear sRGB → (n, 5) network coordinates in [0, 1]."""
        return self._look_up(colours, units=False)

    def skins(self, colours: ArrayLike) -> NDArray[np.float32]:
        """(n, 3) calibrated linear sRGB → (n, 5) parameters in their units, within their ranges."""
        return self._look_up(colours, units=True)

    def _look_up(self, colours: ArrayLike, units: bool) -> NDArray[np.float32]:
        from cutis.inverse.baked_kernel import look_up
        from cutis.inverse.units_kernel import RANGES

        rgb = np.ascontiguousarray(colours, dtype=np.float32)
        out = np.empty((len(rgb), 5), dtype=np.float32)
        low = np.array(LOW, dtype=np.float32)
        scale = (np.array(CELLS) / (np.array(HIGH) - np.array(LOW))).astype(np.float32)
        look_up(rgb, self._lanes, low, scale, RANGES, units, out)
        return out

    @cached_property
    def _lanes(self) -> NDArray[np.float32]:
        """The coefficients in eight lanes, of which the last three are 0."""
        padding = [(0, 0)] * 3 + [(0, LANES - 5)]
        return np.ascontiguousarray(np.pad(self.coefficients, padding))


def chart_colours() -> NDArray[np.float32]:
    """(nodes, 3) linear sRGB at the nodes of the chart, a slowest."""
    axes = [np.linspace(low, high, n + 1) for low, high, n in zip(LOW, HIGH, CELLS, strict=True)]
    a, b, c = np.meshgrid(*axes, indexing="ij")
    green = a**4
    rgb = np.stack([green * b / (1 - b), green, green * c / (1 - c)], axis=-1)
    return rgb.reshape(-1, 3).astype(np.float32)


def bake(encoder: Perceptron, progress: Callable[[int, int], None] | None = None) -> Baked:
    """Fits every node of the chart (seconds), with what `encoder` estimates as prior mean.

    An encoder trained on skins spread evenly over the albedo space estimates the mean of all skins
    of a colour; the fit moves from there to the nearest skin that has exactly that colour.
    `progress(done, total)` is called now and then.
    """
    colours = chart_colours()
    space = albedo_space()
    nodes = np.empty((len(colours), 5), dtype=np.float32)
    step = -(-len(colours) // 20)
    for start in range(0, len(colours), step):
        part = slice(start, start + step)
        centres = encoder(colours[part])
        nodes[part] = fit(space, colours[part], centres, np.diag(PRECISION), TOLERANCE)
        if progress:
            progress(min(start + step, len(colours)), len(colours))
    return Baked(_splines(nodes.reshape(*(n + 1 for n in CELLS), 5)))


def _splines(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Values at the nodes of each axis → coefficients with natural ends, one more at each end."""
    coefficients = values.astype(np.float64)
    for axis in range(3):
        n = coefficients.shape[axis]
        system = np.zeros((n + 2, n + 2))
        rows = np.arange(n)
        for shift, weight in ((0, 1 / 6), (1, 2 / 3), (2, 1 / 6)):
            system[rows + 1, rows + shift] = weight
        system[0, :3] = system[-1, -3:] = (1, -2, 1)  # no curvature at the ends
        inverse = np.linalg.inv(system)[:, 1:-1]
        coefficients = np.moveaxis(np.tensordot(inverse, coefficients, axes=(1, axis)), 0, axis)
    return np.ascontiguousarray(coefficients, dtype=np.float32)


def save_baked(baked: Baked, file: Path) -> None:
    """Writes a baked inverse as .npz, coefficients in steps of 1/65535 of their range.

    Each is stored as its difference to the one before along c, which packs to half the size.
    """
    low, high = float(baked.coefficients.min()), float(baked.coefficients.max())
    steps = np.round((baked.coefficients - low) / (high - low) * 65535).astype(np.uint16)
    changes = np.diff(steps, axis=2, prepend=np.uint16(0))  # modulo 65536, as the sum is
    np.savez_compressed(file, changes=changes, ends=np.array([low, high]))


def load_baked(file: Path) -> Baked:
    """Reads what `save_baked` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        low, high = stored["ends"]
        steps = np.cumsum(stored["changes"], axis=2, dtype=np.uint16)
        scale = np.float32((high - low) / 65535)
        return Baked(np.float32(low) + steps.astype(np.float32) * scale)
