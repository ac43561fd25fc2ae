"""Compiled parts of the steady inverse: sums over cells, what neighbours expect, the correction.

What they compute is in `steady.py`; NumPy forms of the same are in its tests.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

ROWS, PIECE = 1, 4096
"""Rows of cells, and texels, that a thread works on at a time."""
SUMS = 15
"""Per cell: weight, 2 strong maps, their 3 products, 3 weak maps, 6 products of strong and weak."""
LIKE, LANES = 30, 32
"""Lane of the gains that says how much a colour is that of skin, and their number."""
DARK, ZERO, HALF, ONE = np.float32(1e-6), np.float32(0), np.float32(0.5), np.float32(1)
TWO = np.float32(2)


@compiled(fast=True, inline=True)
def _node(x: Any, low: Any, scale: Any, cells: Any) -> Any:
    """Node below a coordinate of the chart (`baked.py`), and how far it is beyond."""
    place = min(max((x - low) * scale, ZERO), np.float32(cells))
    i = min(int(place), cells - 1)
    return i, place - np.float32(i)


@on_all_cores(ROWS, fast=True)
def sum_cells(
    start: Any, stop: Any, cell: Any, u: Any, colours: Any, inside: Any, gains: Any, low: Any,
    scale: Any, sums: Any
) -> None:  # fmt: skip
    """Adds up coordinates u (h, W, 5) in cells; sums (⌈h / cell⌉, ⌈W / cell⌉, SUMS), from 0."""
    high, wide = inside.shape
    for i in range(start, stop):
        for y in range(i * cell, min((i + 1) * cell, high)):
            for x in range(wide):
                if not inside[y, x]:
                    continue
                red, green = max(colours[y, x, 0], DARK), max(colours[y, x, 1], DARK)
                blue = max(colours[y, x, 2], DARK)
                a, f = _node(np.sqrt(np.sqrt(green)), low[0], scale[0], gains.shape[0] - 1)
                b, g = _node(red / (red + green), low[1], scale[1], gains.shape[1] - 1)
                c, h = _node(blue / (blue + green), low[2], scale[2], gains.shape[2] - 1)
                likeness = ZERO
                for p in range(2):
                    for q in range(2):
                        share = (f if p else ONE - f) * (g if q else ONE - g)
                        near, far = gains[a + p, b + q, c, LIKE], gains[a + p, b + q, c + 1, LIKE]
                        likeness += share * (near + h * (far - near))
                weight = float(likeness)
                j = x // cell
                m, s = float(u[y, x, 0]), float(u[y, x, 1])
                sums[i, j, 0] += weight
                sums[i, j, 1] += weight * m
                sums[i, j, 2] += weight * s
                sums[i, j, 3] += weight * m * m
                sums[i, j, 4] += weight * m * s
                sums[i, j, 5] += weight * s * s
                for k in range(3):
                    w = weight * u[y, x, 2 + k]
                    sums[i, j, 6 + k] += w
                    sums[i, j, 9 + k] += w * m
                    sums[i, j, 12 + k] += w * s


@on_all_cores(ROWS, fast=True)
def expect(
    start: Any, stop: Any, cell: Any, u: Any, inside: Any, lines: Any, fine: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (h, W, 5) with what neighbours expect, rows of cells from `start` to `stop`.

    Weak maps are lines (⌈h / cell⌉, ⌈W / cell⌉, 9) in the strong ones, between cells; strong maps
    are those of u (h, W, 5), if `fine` means over 3 × 3 texels.
    """
    high, wide = inside.shape
    last_row, last_column = lines.shape[0] - 1, lines.shape[1] - 1
    line = np.empty(9, np.float32)
    for y in range(start * cell, min(stop * cell, high)):
        p = (np.float32(y) + HALF) / np.float32(cell) - HALF
        f = p - np.floor(p)
        top, bottom = max(int(np.floor(p)), 0), min(int(np.floor(p)) + 1, last_row)
        for x in range(wide):
            if not inside[y, x]:
                continue
            q = (np.float32(x) + HALF) / np.float32(cell) - HALF
            g = q - np.floor(q)
            left, right = max(int(np.floor(q)), 0), min(int(np.floor(q)) + 1, last_column)
            for k in range(9):
                above = (ONE - g) * lines[top, left, k] + g * lines[top, right, k]
                below = (ONE - g) * lines[bottom, left, k] + g * lines[bottom, right, k]
                line[k] = (ONE - f) * above + f * below
            m, s = u[y, x, 0], u[y, x, 1]
            for k in range(3):
                w = line[k] * m + line[3 + k] * s + line[6 + k]
                out[y, x, 2 + k] = min(max(w, ZERO), ONE)
            if fine:
                total, m, s = ZERO, ZERO, ZERO
                for j in range(max(y - 1, 0), min(y + 2, high)):
                    for i in range(max(x - 1, 0), min(x + 2, wide)):
                        if inside[j, i]:
                            share = (TWO if j == y else ONE) * (TWO if i == x else ONE)
                            total += share
                            m += share * u[j, i, 0]
                            s += share * u[j, i, 1]
                m, s = m / total, s / total
            out[y, x, 0], out[y, x, 1] = m, s


@on_all_cores(PIECE, fast=True)
def correct(
    start: Any, stop: Any, colours: Any, expected: Any, at: Any, seen: Any, own: Any, gains: Any,
    low: Any, scale: Any, limit: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (n, 5) with expected + K (colour − seen + J (at − expected)), in [0, 1].

    `seen` (n, 3) are the colours of skins `at` (n, 5). K, lanes 0 to 14 of `gains`, and J, lanes 15
    to 29, are those of the colour. With a `limit` above 0, skins whose colour is off by more than
    `limit` (c̄ + 0.01)^⅔ go back to `own` (n, 5).
    """
    line, wrong = np.empty(LANES, np.float32), np.empty(3, np.float32)
    for n in range(start, stop):
        red, green, blue = (
            max(colours[n, 0], DARK), max(colours[n, 1], DARK), max(colours[n, 2], DARK)
        )  # fmt: skip
        a, f = _node(np.sqrt(np.sqrt(green)), low[0], scale[0], gains.shape[0] - 1)
        b, g = _node(red / (red + green), low[1], scale[1], gains.shape[1] - 1)
        c, h = _node(blue / (blue + green), low[2], scale[2], gains.shape[2] - 1)
        e, d, o = ONE - f, ONE - g, ONE - h
        for k in range(LANES):
            line[k] = (
                e * d * (o * gains[a, b, c, k] + h * gains[a, b, c + 1, k])
                + e * g * (o * gains[a, b + 1, c, k] + h * gains[a, b + 1, c + 1, k])
                + f * d * (o * gains[a + 1, b, c, k] + h * gains[a + 1, b, c + 1, k])
                + f * g * (o * gains[a + 1, b + 1, c, k] + h * gains[a + 1, b + 1, c + 1, k])
            )
        off, mean = ZERO, ZERO
        for k in range(3):
            wrong[k] = colours[n, k] - seen[n, k]
            off += wrong[k] * wrong[k]
            mean += max(colours[n, k], ZERO)
            for p in range(5):
                wrong[k] += line[15 + 5 * k + p] * (at[n, p] - expected[n, p])
        trusted = ONE
        if limit > ZERO:
            size = np.cbrt(mean / np.float32(3) + np.float32(0.01))
            ratio = off / (limit * limit * size * size * size * size)
            trusted = ONE / (ONE + ratio * ratio)
        for p in range(5):
            value = expected[n, p]
            for k in range(3):
                value += line[3 * p + k] * wrong[k]
            value = own[n, p] + trusted * (value - own[n, p])
            out[n, p] = min(max(value, ZERO), ONE)
