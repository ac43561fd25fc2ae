"""Compiled sums over texels that reports are made of; tests work them out again in NumPy."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.warp_kernel import coordinate_of, slope_of

PIECE, ROWS = 2048, 16
"""Texels, and rows of them, that a thread works on at a time."""


@on_all_cores(ROWS)
def coordinates(start: Any, stop: Any, maps: Any, inside: Any, axes: Any, out: Any) -> None:
    """Fills out (h, W, p) with coordinates of p maps (h, W) where `inside`, else 0.

    `axes` (5, p) are those of `warp.py`.
    """
    for row in range(start, stop):
        for p in range(out.shape[2]):
            values = maps[p]
            for column in range(inside.shape[1]):
                u = np.float32(0)
                if inside[row, column]:
                    u = np.float32(coordinate_of(values[row, column], axes, p))
                out[row, column, p] = u


@compiled()
def count(u: Any, inside: Any, counts: Any) -> None:
    """Adds coordinates (h, W, p) where `inside` to counts (p, bins)."""
    bins = counts.shape[1]
    for row in range(u.shape[0]):
        for column in range(u.shape[1]):
            if inside[row, column]:
                for p in range(counts.shape[0]):
                    place = int(u[row, column, p] * bins)
                    counts[p, min(max(place, 0), bins - 1)] += 1


@compiled()
def count_spread(sigmas: Any, u: Any, inside: Any, axes: Any, even: Any, share: Any) -> None:
    """Counts standard deviations, p of (h, W), where `inside`.

    `even` (p, bins) in coordinates, by the slope at u (h, W, p); `share` (p, bins) as shares of the
    width of the range.
    """
    bins = even.shape[1]
    for p in range(even.shape[0]):
        values, width = sigmas[p], axes[4, p] - axes[3, p]
        for row in range(u.shape[0]):
            for column in range(u.shape[1]):
                if inside[row, column]:
                    sigma = values[row, column]
                    slope = slope_of(u[row, column, p], axes, p)
                    even[p, max(min(int(sigma / slope * bins), bins - 1), 0)] += 1
                    share[p, max(min(int(sigma / width * bins), bins - 1), 0)] += 1


@on_all_cores(ROWS)
def differences(start: Any, stop: Any, values: Any, where: Any, sums: Any) -> None:
    """Fills sums (h, channels), row by row, with differences of neighbours in values (h, W, …).

    To the right and below, absolute, where both texels are `where`.
    """
    height, width, channels = values.shape
    for row in range(start, stop):
        for p in range(channels):
            sums[row, p] = 0.0
        for column in range(width):
            if where[row, column]:
                right = column + 1 < width and where[row, column + 1]
                below = row + 1 < height and where[row + 1, column]
                for p in range(channels):
                    here = values[row, column, p]
                    if right:
                        sums[row, p] += abs(here - values[row, column + 1, p])
                    if below:
                        sums[row, p] += abs(here - values[row + 1, column, p])
