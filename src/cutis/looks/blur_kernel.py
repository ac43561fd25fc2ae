"""Compiled Gaussian blurs that leave out what is masked; tests work them out by SciPy."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

ROWS = 8
"""Rows that a thread works on at a time."""


@on_all_cores(ROWS)
def along_rows(start: Any, stop: Any, values: Any, taps: Any, out: Any) -> None:
    """Fills out (h, W) with values (h, W) folded with taps (2 r + 1,) along rows; 0 beyond ends."""
    reach, width = len(taps) // 2, values.shape[1]
    for row in range(start, stop):
        for column in range(width):
            out[row, column] = np.float32(0)
        for k in range(len(taps)):
            first, last = max(0, reach - k), min(width, width + reach - k)
            for column in range(first, last):
                out[row, column] += taps[k] * values[row, column + k - reach]


@on_all_cores(ROWS)
def along_columns(start: Any, stop: Any, values: Any, taps: Any, out: Any) -> None:
    """The same along columns."""
    reach, height, width = len(taps) // 2, values.shape[0], values.shape[1]
    for row in range(start, stop):
        for column in range(width):
            out[row, column] = np.float32(0)
        for k in range(len(taps)):
            other = row + k - reach
            if 0 <= other < height:
                for column in range(width):
                    out[row, column] += taps[k] * values[other, column]


@compiled()
def add_up(values: Any, weights: Any, first_row: Any, step: Any, sums: Any, counts: Any) -> None:
    """Adds rows (h, W) to sums and counts of squares of `step` texels, row by row.

    Whichever rows come together, what is added in which order is the same.
    """
    for row in range(values.shape[0]):
        cell = (first_row + row) // step
        for column in range(values.shape[1]):
            weight = weights[row, column]
            if weight > 0:
                sums[cell, column // step] += weight * values[row, column]
                counts[cell, column // step] += weight


@on_all_cores(ROWS)
def drawn_large(
    start: Any, stop: Any, sums: Any, counts: Any, first_row: Any, step: Any, out: Any
) -> None:
    """Fills out (h, W) with sums over counts between cells, by cubic B-splines; NaN where none."""
    cells_high, cells_wide = sums.shape
    line, count = np.empty(cells_wide, np.float32), np.empty(cells_wide, np.float32)
    for row in range(start, stop):
        place = (first_row + row + 0.5) / step - 0.5
        cell = int(np.floor(place))
        w0, w1, w2, w3 = _spline(place - cell)
        for column in range(cells_wide):
            line[column] = np.float32(0)
            count[column] = np.float32(0)
        for k in range(4):
            other = cell + k - 1
            if 0 <= other < cells_high:
                weight = w0 if k == 0 else w1 if k == 1 else w2 if k == 2 else w3
                for column in range(cells_wide):
                    line[column] += weight * sums[other, column]
                    count[column] += weight * counts[other, column]
        for column in range(out.shape[1]):
            place = (column + 0.5) / step - 0.5
            cell_x = int(np.floor(place))
            v0, v1, v2, v3 = _spline(place - cell_x)
            total, share = np.float32(0), np.float32(0)
            for k in range(4):
                other = cell_x + k - 1
                if 0 <= other < cells_wide:
                    weight = v0 if k == 0 else v1 if k == 1 else v2 if k == 2 else v3
                    total += weight * line[other]
                    share += weight * count[other]
            out[row, column] = total / share if share > 1e-6 else np.nan


@compiled(inline=True)
def _spline(t: Any) -> Any:
    """Weights of the four nodes around a place, a share t behind the second."""
    s = 1.0 - t
    w0, w3 = s * s * s / 6.0, t * t * t / 6.0
    w1 = 2.0 / 3.0 - 0.5 * t * t * (2.0 - t)
    w2 = 2.0 / 3.0 - 0.5 * s * s * (2.0 - s)
    return np.float32(w0), np.float32(w1), np.float32(w2), np.float32(w3)
