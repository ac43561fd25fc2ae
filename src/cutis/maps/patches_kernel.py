"""Compiled sums of cubic splines over a grid of texels."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import on_all_cores

ROWS = 16
"""Rows that a thread works on at a time."""


@on_all_cores(ROWS)
def add_surface(
    start: Any, stop: Any, table: Any, down: Any, down_weights: Any, along: Any, along_weights: Any,
    out: Any
) -> None:  # fmt: skip
    """Adds to out (h, W) the surface of a spline whose coefficients are `table` (n, n).

    Row r has the four coefficients from down[r] on with down_weights[r] (4,), columns likewise.
    """
    count = table.shape[1]
    line = np.empty(count)
    for row in range(start, stop):
        first = down[row]
        for j in range(count):
            line[j] = (
                down_weights[row, 0] * table[first, j]
                + down_weights[row, 1] * table[first + 1, j]
                + down_weights[row, 2] * table[first + 2, j]
                + down_weights[row, 3] * table[first + 3, j]
            )
        for column in range(out.shape[1]):
            k = along[column]
            value = (
                along_weights[column, 0] * line[k]
                + along_weights[column, 1] * line[k + 1]
                + along_weights[column, 2] * line[k + 2]
                + along_weights[column, 3] * line[k + 3]
            )
            out[row, column] += np.float32(value)
