"""Compiled strokes of a brush."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

ROWS = 16
"""Rows that a thread works on at a time."""


@compiled()
def squared(x: Any, y: Any, ax: Any, ay: Any, bx: Any, by: Any) -> Any:
    """Squared distance of a point to the line from a to b."""
    along, down = bx - ax, by - ay
    length = along * along + down * down
    t = 0.0
    if length > 0:
        t = min(max(((x - ax) * along + (y - ay) * down) / length, 0.0), 1.0)
    dx, dy = x - ax - t * along, y - ay - t * down
    return dx * dx + dy * dy


@on_all_cores(ROWS)
def paint(
    start: Any, stop: Any, first: Any, points: Any, ends: Any, brushes: Any, out: Any
) -> None:
    """Paints strokes on out (h, W), whose rows are those from `first` on.

    points (n, 2) are in texels; stroke s has those from ends[s] to ends[s + 1], and brushes[s]:
    middle and width of its edge, opacity, whether it erases.
    """
    columns = out.shape[1]
    near = np.empty(columns)
    for row in range(start, stop):
        y = first + row + 0.5
        for stroke in range(len(brushes)):
            middle, width, opacity, erase = brushes[stroke]
            reach = middle + width / 2
            left, right = columns, 0
            for k in range(ends[stroke], ends[stroke + 1]):
                b = k if k + 1 == ends[stroke + 1] else k + 1
                if b == k and k > ends[stroke]:
                    continue  # the end of a line, which the piece before it has
                ax, ay, bx, by = points[k, 0], points[k, 1], points[b, 0], points[b, 1]
                if min(ay, by) - reach >= y or max(ay, by) + reach <= y:
                    continue
                # the part of the piece that is near the row in height
                low, high = 0.0, 1.0
                if ay != by:
                    one, two = (y - reach - ay) / (by - ay), (y + reach - ay) / (by - ay)
                    low, high = max(min(one, two), 0.0), min(max(one, two), 1.0)
                cx, dx = ax + low * (bx - ax), ax + high * (bx - ax)
                from_x = max(int(np.floor(min(cx, dx) - reach)), 0)
                to_x = min(int(np.ceil(max(cx, dx) + reach)) + 1, columns)
                if from_x >= to_x:
                    continue
                if left > right:
                    left, right = from_x, from_x
                while left > from_x:
                    left -= 1
                    near[left] = np.inf
                while right < to_x:
                    near[right] = np.inf
                    right += 1
                for column in range(from_x, to_x):
                    far = squared(column + 0.5, y, ax, ay, bx, by)
                    near[column] = min(near[column], far)
            for column in range(left, right):
                if near[column] >= reach * reach:
                    continue
                t = min(max((np.sqrt(near[column]) - middle) / width + 0.5, 0.0), 1.0)
                cover = opacity * (1 - t * t * (3 - 2 * t))
                before = out[row, column]
                out[row, column] = np.float32(
                    before * (1 - cover) if erase > 0 else 1 - (1 - before) * (1 - cover)
                )
