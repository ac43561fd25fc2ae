"""Compiled steps of another tone: how far texels are along the path, and where they go."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.difference_kernel import relative_lab

ROWS = 16
"""Rows that a thread works on at a time."""
DARKEST = 2e-3
"""Of linear sRGB: what is darker counts as this."""
HAIR = (0.9, 1.5)
"""Natural logarithms that a texel is darker than the face's median where hair begins, and where it
is sure; less where its colour is none of skin, more where it is red."""
SOFT = 0.2
"""Natural logarithm over which what gets too light is held."""


@compiled(inline=True)
def _hair(r: Any, g: Any, b: Any, confidence: Any) -> Any:
    """How much a texel, by its log RGB over the face's median, is hair, lashes or a pupil: 0–1."""
    darker = -(0.25 * r + 0.6 * g + 0.15 * b)
    red = r - 0.5 * (g + b)
    t = (darker - 1.2 * max(red, 0.0) + 0.3 * (1.0 - confidence) - 0.9) / 0.6
    t = min(max(t, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@compiled(inline=True)
def _red(r: Any, g: Any, b: Any, low: Any, high: Any) -> Any:
    """How much a texel, by its log RGB over the face's median, is red as lips are: 0–1."""
    t = min(max((r - 0.5 * (g + b) - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@compiled(inline=True)
def _from_f(f: Any) -> Any:
    return f * f * f if f > 6.0 / 29.0 else (116.0 * f - 16.0) * 27.0 / 24389.0


@compiled(inline=True)
def _log(value: Any) -> Any:
    return np.log(max(np.float64(value), 2e-3))


@on_all_cores(ROWS)
def along(
    start: Any, stop: Any, colours: Any, confidence: Any, inside: Any, median: Any, line: Any,
    limit: Any, out: Any, weights: Any
) -> None:  # fmt: skip
    """Fills out (h, W) with degrees along the path, and weights (h, W) with how much they count.

    `line` (3,) tells them from log RGB over `median` (3,); beyond `limit` degrees they grow slower.
    """
    for row in range(start, stop):
        for column in range(colours.shape[1]):
            out[row, column] = np.float32(0)
            weights[row, column] = np.float32(0)
            if inside[row, column]:
                r = _log(colours[row, column, 0]) - median[0]
                g = _log(colours[row, column, 1]) - median[1]
                b = _log(colours[row, column, 2]) - median[2]
                degrees = line[0] * r + line[1] * g + line[2] * b
                over = degrees / limit
                out[row, column] = np.float32(degrees / np.sqrt(1.0 + over * over))
                sure = np.float64(confidence[row, column])
                share = (1.0 - _hair(r, g, b, sure)) * min(max(sure, 0.05), 1.0)
                weights[row, column] = np.float32(share)


@compiled(inline=True)
def _on_path(path: Any, low: Any, step: Any, tone: Any, channel: Any) -> Any:
    place = (tone - low) / step
    cell = int(min(max(np.floor(place), 0.0), path.shape[0] - 2.0))
    share = place - cell
    return path[cell, channel] * (1.0 - share) + path[cell + 1, channel] * share


@on_all_cores(ROWS)
def move(
    start: Any, stop: Any, colours: Any, confidence: Any, weights: Any, degrees: Any, median: Any,
    line: Any, light: Any, direction: Any, shift: Any, aside: Any, mix: Any, path: Any, low: Any,
    step: Any, tones: Any, strength: Any, lightest: Any, dark: Any, reds: Any, scale: Any,
    to_xyz: Any, to_rgb: Any, out: Any
) -> None:  # fmt: skip
    """Fills out (h, W, 3) with colours (h, W, 3) moved to another tone, `weights` (h, W) of it.

    With d log RGB over `median`, δ `degrees` (h, W), and e = d − (line · d) direction − light · d
    what is neither along the path nor a change of light:

        log c → log c + shift + path(t1 + strength δ) − path(t0 + δ) + (aside − 1) e + mix d

    `tones` is (t0, t1). What is red, by the ends `reds`, keeps its difference to the median in
    CIELAB, times `scale`. Red stays below `lightest`. Hair stays, but is not left lighter than
    `dark` (3,), log RGB. `to_xyz` goes to XYZ over that of white, `to_rgb` back.
    """
    middle, later = np.empty(3), np.empty(3)
    for c in range(3):
        middle[c] = np.exp(median[c])
        later[c] = np.exp(
            median[c] + shift[c] + _on_path(path, low, step, tones[1], c)
            - _on_path(path, low, step, tones[0], c)
        )  # fmt: skip
    l0, a0, b0 = relative_lab(middle[0], middle[1], middle[2], to_xyz)
    l1, a1, b1 = relative_lab(later[0], later[1], later[2], to_xyz)
    xyz = np.empty(3)
    d = np.empty(3)
    new = np.empty(3)
    for row in range(start, stop):
        for column in range(colours.shape[1]):
            for c in range(3):
                out[row, column, c] = colours[row, column, c]
            share = np.float64(weights[row, column])
            if share <= 0:
                continue
            for c in range(3):
                d[c] = _log(colours[row, column, c]) - median[c]
            raw = line[0] * d[0] + line[1] * d[1] + line[2] * d[2]
            shade = light[0] * d[0] + light[1] * d[1] + light[2] * d[2]
            delta = np.float64(degrees[row, column])
            kept = _hair(d[0], d[1], d[2], np.float64(confidence[row, column]))
            # what is mixed gets less where it is far from the face
            far = 1.0 / np.sqrt(1.0 + (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 1.5)
            for c in range(3):
                left = d[c] - raw * direction[c] - shade
                new[c] = (
                    shift[c] + (aside[c] - 1.0) * left
                    + _on_path(path, low, step, tones[1] + strength * delta, c)
                    - _on_path(path, low, step, tones[0] + delta, c)
                    + far * (mix[c, 0] * d[0] + mix[c, 1] * d[1] + mix[c, 2] * d[2])
                )  # fmt: skip
            lips = _red(d[0], d[1], d[2], reds[0], reds[1])
            if lips > 0:
                lightness, a, b = relative_lab(
                    np.exp(d[0] + median[0]), np.exp(d[1] + median[1]), np.exp(d[2] + median[2]),
                    to_xyz,
                )  # fmt: skip
                fy = (l1 + scale * (lightness - l0) + 16.0) / 116.0
                xyz[0] = _from_f(fy + (a1 + scale * (a - a0)) / 500.0)
                xyz[1] = _from_f(fy)
                xyz[2] = _from_f(fy - (b1 + scale * (b - b0)) / 200.0)
                for c in range(3):
                    value = to_rgb[c, 0] * xyz[0] + to_rgb[c, 1] * xyz[1] + to_rgb[c, 2] * xyz[2]
                    whole = _log(value) - d[c] - median[c]
                    new[c] = (1.0 - lips) * new[c] + lips * whole
            own = d[0] + median[0]
            over = own + new[0] - max(lightest, own)
            held = over - 0.2 * np.tanh(over / 0.2) if over > 0 else 0.0
            for c in range(3):
                own = d[c] + median[c]
                whole = new[c] - held
                by = (1.0 - kept) * whole
                if by > whole and own + by > dark[c]:  # darker skin around lighter hair: a halo
                    by = max(whole, min(by, dark[c] - own))
                out[row, column, c] = np.float32(
                    np.float64(colours[row, column, c]) * np.exp(share * by)
                )
