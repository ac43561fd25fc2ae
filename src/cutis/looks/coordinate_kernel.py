"""Compiled steps in network coordinates, in which looks blur maps and change their contrast."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

ROWS = 16
"""Rows that a thread works on at a time."""


@compiled(inline=True)
def _coordinate(value: Any, root: Any, low: Any, span: Any) -> Any:
    if root == 3:
        value = np.cbrt(value)
    elif root == 4:
        value = np.sqrt(np.sqrt(value))
    return (value - low) / span


@on_all_cores(ROWS)
def to_coordinates(
    start: Any, stop: Any, values: Any, inside: Any, root: Any, low: Any, span: Any, out: Any
) -> None:
    """Fills out (h, W) with u = (v^(1/root) − low) / span where `inside`, else 0."""
    for row in range(start, stop):
        for column in range(values.shape[1]):
            u = 0.0
            if inside[row, column]:
                u = _coordinate(np.float64(values[row, column]), root, low, span)
            out[row, column] = np.float32(u)


@on_all_cores(ROWS)
def move(
    start: Any, stop: Any, values: Any, by: Any, weight: Any, root: Any, low: Any, span: Any,
    least: Any, most: Any, out: Any, clamped: Any
) -> None:  # fmt: skip
    """Fills out (h, W) with values moved by `by` (h, W) in coordinates, `weight` (h, W) of it.

    Values that do not move are what they were, bit for bit. `clamped` (h,) counts, row by row,
    those that had to be held in 0 to 1.
    """
    for row in range(start, stop):
        clamped[row] = 0
        for column in range(values.shape[1]):
            old, share, shift = values[row, column], weight[row, column], by[row, column]
            new = old
            if share > 0 and shift != 0:
                u = _coordinate(np.float64(old), root, low, span) + shift
                if u < 0 or u > 1:
                    clamped[row] += 1
                    u = min(max(u, 0.0), 1.0)
                base = low + u * span
                moved = base
                for _ in range(root - 1):
                    moved *= base
                moved = min(max(np.float32(moved), least), most)
                new = moved if share >= 1 else np.float32(old + share * (moved - old))
                new = min(max(new, least), most)
            out[row, column] = new
