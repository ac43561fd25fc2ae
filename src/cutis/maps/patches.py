"""Irregular soft-edged patches, for edits that skin wears in patches (vitiligo)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

ALL = slice(None)

OCTAVES = 5
"""Scales of the noise, each half as large and 0.55 as strong as the one before."""
COVERAGE = 0.35
"""Share of the image inside patches."""
EDGE = 0.12
"""Width of the soft edge, in standard deviations of the noise."""


STATISTICS = 512
"""Texels along the longer side of the image that mean, spread and threshold are taken from."""


def patches(shape: tuple[int, int], rows: slice = ALL, seed: int = 7) -> NDArray[np.float32]:
    """(h, W) weights in [0, 1] of some rows of an image of `shape` (H, W).

    Sums of smooth random fields, thresholded with a soft edge. The same seed gives the same patches
    at every resolution of the same aspect, and the same weights however rows are asked for.
    """
    splines = _splines(seed)
    height, width = shape
    scale = STATISTICS / max(shape)
    small = (max(1, round(height * scale)), max(1, round(width * scale)))
    sample = _field(splines, small, slice(None))
    mean, spread = sample.mean(), max(float(sample.std()), 1e-6)
    threshold = np.quantile((sample - mean) / spread, 1 - COVERAGE)
    field = (_field(splines, shape, rows) - mean) / spread
    return np.clip((field - threshold) / EDGE + 0.5, 0.0, 1.0).astype(np.float32)


def _splines(seed: int) -> list[Any]:
    from scipy.interpolate import RectBivariateSpline

    rng = np.random.default_rng(seed)
    sizes = [4 * 2**octave + 4 for octave in range(OCTAVES)]
    return [
        RectBivariateSpline(np.arange(n), np.arange(n), rng.standard_normal((n, n))) for n in sizes
    ]


def _field(splines: list[Any], shape: tuple[int, int], rows: slice) -> NDArray[np.float32]:
    height, width = shape
    longest = max(shape)
    places = np.arange(*rows.indices(height))
    field = np.zeros((len(places), width), dtype=np.float32)
    for octave, spline in enumerate(splines):
        cells = 4 * 2**octave
        y = 1.5 + (places + 0.5) / longest * cells
        x = 1.5 + (np.arange(width) + 0.5) / longest * cells
        field += (0.55**octave * spline(y, x)).astype(np.float32)
    return field
