"""Irregular soft-edged patches, for edits that skin wears in patches (vitiligo)."""

import numpy as np
from numpy.typing import NDArray

OCTAVES = 5
"""Scales of the noise, each half as large and 0.55 as strong as the one before."""
COVERAGE = 0.35
"""Share of the image inside patches."""
EDGE = 0.12
"""Width of the soft edge, in standard deviations of the noise."""


def patches(shape: tuple[int, int], seed: int = 7) -> NDArray[np.float32]:
    """(H, W) weights in [0, 1]: sums of smooth random fields, thresholded with a soft edge.

    The same seed gives the same patches at every resolution of the same aspect.
    """
    from scipy.interpolate import RectBivariateSpline

    rng = np.random.default_rng(seed)
    height, width = shape
    longest = max(shape)
    field = np.zeros(shape, dtype=np.float32)
    for octave in range(OCTAVES):
        cells = 4 * 2**octave
        nodes = np.arange(cells + 4)
        spline = RectBivariateSpline(nodes, nodes, rng.standard_normal((cells + 4, cells + 4)))
        y = 1.5 + (np.arange(height) + 0.5) / longest * cells
        x = 1.5 + (np.arange(width) + 0.5) / longest * cells
        field += (0.55**octave * spline(y, x)).astype(np.float32)
    field = (field - field.mean()) / max(float(field.std()), 1e-6)
    threshold = np.quantile(field, 1 - COVERAGE)
    return np.clip((field - threshold) / EDGE + 0.5, 0.0, 1.0).astype(np.float32)
