"""Compiled steps of views: texels halved, and colours as eight bits of sRGB."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import on_all_cores

ROWS = 16
"""Rows that a thread works on at a time."""
STEPS = 1 << 16
"""Entries of the table of the sRGB curve: its steepest part has 20 of them a code."""


@on_all_cores(ROWS)
def halve(start: Any, stop: Any, values: Any, weights: Any, out: Any) -> None:
    """Fills out (h, w, C) with means of 2 × 2 texels of values (H, W, C) weighted by (H, W).

    0 where all weights are; odd last rows and columns are means of what is there.
    """
    height, width, channels = values.shape
    for row in range(start, stop):
        for column in range(out.shape[1]):
            total = np.float32(0)
            for c in range(channels):
                out[row, column, c] = np.float32(0)
            for y in range(2 * row, min(2 * row + 2, height)):
                for x in range(2 * column, min(2 * column + 2, width)):
                    weight = weights[y, x]
                    total += weight
                    for c in range(channels):
                        out[row, column, c] += weight * values[y, x, c]
            if total > 0:
                for c in range(channels):
                    out[row, column, c] /= total


@on_all_cores(ROWS)
def to_codes(start: Any, stop: Any, colours: Any, table: Any, out: Any) -> None:
    """Fills out (H, W, 3), uint8, with linear colours (H, W, 3) by a table of the curve."""
    most = len(table) - 1
    for row in range(start, stop):
        for column in range(colours.shape[1]):
            for c in range(3):
                value = colours[row, column, c] * most
                if not value > 0:  # NaN too
                    value = 0
                elif value > most:
                    value = most
                out[row, column, c] = table[int(value + np.float32(0.5))]


@on_all_cores(ROWS)
def recolour(
    start: Any, stop: Any, source: Any, mask: Any, before: Any, after: Any, darkest: Any, out: Any
) -> None:
    """Fills out (H, W, 3) with source · (1 + mask (after / max(before, darkest) − 1))."""
    for row in range(start, stop):
        for column in range(source.shape[1]):
            share = mask[row, column]
            for c in range(3):
                value = source[row, column, c]
                old, new = before[row, column, c], after[row, column, c]
                if share > 0 and new != old:
                    value *= np.float32(1) + share * (new / max(old, darkest) - np.float32(1))
                out[row, column, c] = value
