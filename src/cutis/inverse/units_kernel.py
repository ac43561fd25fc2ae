"""Compiled conversion between network coordinates and units; plain form: `optics.parameters`.

Melanin is the cube, blood the fourth power of what is linear in its coordinate, the other three
are linear themselves.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.optics import PARAMETERS

PIECE = 1 << 14
"""Skins that a thread converts at a time."""
THIRD, ZERO, ONE = np.float32(1 / 3), np.float32(0), np.float32(1)
RANGES = np.array(
    [
        [p.low ** (1 / p.root) for p in PARAMETERS],
        [p.high ** (1 / p.root) - p.low ** (1 / p.root) for p in PARAMETERS],
        [p.low for p in PARAMETERS],
        [p.high for p in PARAMETERS],
    ],
    dtype=np.float32,
)
"""Rows: low end and span of the roots, low and high end of the parameters."""


@compiled(fast=True)
def store_units(coordinates: Any, ranges: Any, out: Any) -> None:
    """Fills out (n, 5) with the parameters of coordinates (n or more, 5 or more), clamped."""
    for i in range(len(out)):
        for p in range(5):
            u = min(max(coordinates[i, p], ZERO), ONE)
            out[i, p] = ranges[0, p] + u * ranges[1, p]
        melanin, blood = out[i, 0], out[i, 1]
        out[i, 0] = melanin * melanin * melanin
        out[i, 1] = blood * blood * (blood * blood)
        for p in range(5):
            out[i, p] = min(max(out[i, p], ranges[2, p]), ranges[3, p])


@on_all_cores(PIECE, fast=True)
def _to_units(start: Any, stop: Any, coordinates: Any, ranges: Any, out: Any) -> None:
    store_units(coordinates[start:stop], ranges, out[start:stop])


@on_all_cores(PIECE, fast=True)
def _from_units(start: Any, stop: Any, skins: Any, ranges: Any, out: Any) -> None:
    for i in range(start, stop):
        out[i, 0] = (skins[i, 0] ** THIRD - ranges[0, 0]) / ranges[1, 0]
        out[i, 1] = (np.sqrt(np.sqrt(skins[i, 1])) - ranges[0, 1]) / ranges[1, 1]
        for p in range(2, 5):
            out[i, p] = (skins[i, p] - ranges[0, p]) / ranges[1, p]


def to_units(coordinates: NDArray[np.float32]) -> NDArray[np.float32]:
    """`optics.from_coordinates` of (n, 5) float32."""
    out = np.empty_like(coordinates)
    _to_units(len(out), coordinates, RANGES, out)
    return out


def from_units(skins: NDArray[np.float32]) -> NDArray[np.float32]:
    """`optics.to_coordinates` of (n, 5) float32."""
    out = np.empty_like(skins)
    _from_units(len(out), skins, RANGES, out)
    return out
