"""Irregular patches, for edits that skin wears in patches (vitiligo) or blotches."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.arrays import Map

ALL = slice(None)

OCTAVES = 5
"""Scales of the noise, each half as large and 0.55 as strong as the one before."""
FINEST = 512
"""Cells along the longer side at most."""
SIZE = 0.25
"""Of the largest scale: cells of the noise, as a fraction of the longer side."""
COVERAGE = 0.35
"""Share of the image inside patches."""
EDGE = 0.12
"""Width of the soft edge, in standard deviations of the noise."""
STATISTICS = 512
"""Texels along the longer side of the image that mean, spread and threshold are taken from."""


def patches(
    shape: tuple[int, int],
    rows: slice = ALL,
    seed: int = 7,
    size: float = SIZE,
    coverage: float = COVERAGE,
    edge: float = EDGE,
    octaves: int = OCTAVES,
) -> Map:
    """(h, W) weights in [0, 1] of some rows of an image of `shape` (H, W).

    Sums of smooth random fields, thresholded with a soft edge. The same seed gives the same patches
    at every resolution of the same aspect, and the same weights however rows are asked for.
    """
    height, width = shape
    scale = STATISTICS / max(shape)
    small = (max(1, round(height * scale)), max(1, round(width * scale)))
    mean, spread, threshold = _statistics(small, seed, size, coverage, octaves)
    field = (_field(seed, size, octaves, shape, rows) - mean) / spread
    return np.clip((field - threshold) / edge + 0.5, 0.0, 1.0).astype(np.float32)


@lru_cache(maxsize=64)
def _statistics(
    shape: tuple[int, int], seed: int, size: float, coverage: float, octaves: int
) -> tuple[np.float32, float, np.float32]:
    """Mean and standard deviation of the noise, and what of it is inside patches."""
    sample = _field(seed, size, octaves, shape, ALL)
    mean, spread = sample.mean(), max(float(sample.std()), 1e-6)
    return mean, spread, np.quantile((sample - mean) / spread, 1 - coverage)


@lru_cache(maxsize=16)
def _splines(seed: int, size: float, octaves: int) -> list[tuple[float, NDArray[np.float64], Any]]:
    """Cells, coefficients (n, n) and knots of each octave."""
    from scipy.interpolate import RectBivariateSpline

    rng, found = np.random.default_rng(seed), []
    for octave in range(octaves):
        cells = 2**octave / size
        if octave and cells > FINEST:
            break
        nodes = np.arange(int(np.ceil(cells)) + 4)
        noise = rng.standard_normal((len(nodes), len(nodes)))
        spline = RectBivariateSpline(nodes, nodes, noise)
        table = spline.get_coeffs().reshape(noise.shape)
        found.append((cells, 0.55**octave * table, spline.get_knots()[0]))
    return found


def _field(seed: int, size: float, octaves: int, shape: tuple[int, int], rows: slice) -> Map:
    from cutis.maps.patches_kernel import add_surface

    height, width = shape
    down, longest = np.arange(*rows.indices(height)), max(shape)
    field = np.zeros((len(down), width), dtype=np.float32)
    for cells, table, knots in _splines(seed, size, octaves):
        places = [1.5 + (texels + 0.5) / longest * cells for texels in (down, np.arange(width))]
        add_surface(len(down), table, *_basis(places[0], knots), *_basis(places[1], knots), field)
    return field


def _basis(places: NDArray[np.float64], knots: Any) -> tuple[Any, NDArray[np.float64]]:
    """The first of four coefficients that count at each place (n,), and their weights (n, 4)."""
    from scipy.interpolate import BSpline

    matrix = BSpline.design_matrix(places, knots, 3)
    return matrix.indices.reshape(-1, 4)[:, 0].astype(np.int64), matrix.data.reshape(-1, 4)
