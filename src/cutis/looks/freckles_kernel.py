"""Compiled spots of freckles."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import on_all_cores

ROWS = 16
"""Rows that a thread works on at a time."""


@on_all_cores(ROWS)
def strew(
    start: Any, stop: Any, first: Any, spots: Any, soft: Any, edge: Any, reach: Any, out: Any
) -> None:
    """Adds spots (n, 8) to out (h, W), whose rows are those from `first` on.

    They are sorted by height, and none goes further than `reach` texels.
    """
    for row in range(start, stop):
        y = first + row + 0.5
        k = np.searchsorted(spots[:, 1], y - reach)
        while k < len(spots) and spots[k, 1] <= y + reach:
            down, radius = y - spots[k, 1], spots[k, 2]
            if abs(down) < reach:
                left = max(int(np.floor(spots[k, 0] - reach)), 0)
                right = min(int(np.ceil(spots[k, 0] + reach)) + 1, out.shape[1])
                for column in range(left, right):
                    along = column + 0.5 - spots[k, 0]
                    far = np.sqrt(along * along + down * down)
                    wave = 1.0
                    if far > 0:
                        c, s = along / far, down / far
                        c2, s2 = c * c - s * s, 2 * c * s
                        c3, s3 = c2 * c - s2 * s, s2 * c + c2 * s
                        wave += spots[k, 4] * c2 + spots[k, 5] * s2
                        wave += spots[k, 6] * c3 + spots[k, 7] * s3
                    end = radius * wave
                    width = max(end * soft, edge)
                    t = min(max((far - end * (1 - soft / 2)) / width + 0.5, 0.0), 1.0)
                    cover = spots[k, 3] * (1 - t * t * (3 - 2 * t))
                    if cover > 0:
                        before = out[row, column]
                        out[row, column] = np.float32(1 - (1 - before) * (1 - cover))
            k += 1
