"""An edit as a three-dimensional look-up table over stored values, for a .cube.

A .cube has nothing before its grid but one curve per channel, and skin is a thin sheet in RGB, so
most nodes lie where no skin is. The others are worth moving: nodes that lie *on* the edit leave
every cell's error on one side, and the least-squares nodes of `node_fit` halve it.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.arrays import Floats
from cutis.errors import CutisError
from cutis.luts.node_fit import refit
from cutis.luts.recolouring import Recolouring

SHAPER = 4096
"""Entries of the shaper of linear spaces."""
KNEE = 0.05
"""Linear value at which the shaper turns from even in values to even in their ratios."""
LARGEST = 129
"""Nodes along a side that OpenColorIO reads from a .cube."""


class Space(Protocol):
    """An RGB space: anything that says how its stored values become linear sRGB and back."""

    @property
    def name(self) -> str:
        """What it is called."""

    def to_linear_srgb(self, values: ArrayLike) -> Floats:
        """(..., 3) stored values → linear sRGB."""

    def from_linear_srgb(self, rgb: ArrayLike) -> Floats:
        """(..., 3) linear sRGB → stored values."""


@dataclass(frozen=True, eq=False)
class Lut:
    """`table` (n, n, n, 3) by red, green, blue: stored values of a space for shaped values of it.

    `shaper` (SHAPER,) maps values of 0 to 1 to places of 0 to 1 on the grid, the same for the three
    channels; None where the grid is even in the values themselves.
    """

    table: NDArray[np.float32]
    shaper: NDArray[np.float32] | None


def shape(values: ArrayLike) -> Floats:
    """Linear values of 0 to 1 → places on the grid, log(1 + x / KNEE) from 0 to 1."""
    return np.log1p(np.asarray(values) / KNEE) / np.log1p(1 / KNEE)


def unshape(places: ArrayLike) -> Floats:
    """Places of 0 to 1 on the grid → linear values of 0 to 1: the inverse of `shape`."""
    return KNEE * np.expm1(np.asarray(places) * np.log1p(1 / KNEE))


def is_linear(space: Space) -> bool:
    """Whether a space is linear light: twice the values, twice the colour."""
    some = np.array([[0.2, 0.1, 0.05], [0.1, 0.4, 0.3]])
    once, twice = space.to_linear_srgb(some), space.to_linear_srgb(2 * some)
    return bool(np.allclose(2 * once, twice, rtol=1e-5, atol=1e-7))


def edit_lut(edit: Recolouring, size: int, space: Space, *, fit: bool = True) -> Lut:
    """The LUT of an edit (`recolouring`) for albedos stored in `space`, with values from 0 to 1.

    Colours that the edit leaves alone keep their value at every node. Without `fit` the nodes lie
    on the edit. Raises CutisError for sizes outside 2 to LARGEST.
    """
    if not 2 <= size <= LARGEST:
        raise CutisError(f"a LUT has 2 to {LARGEST} nodes along a side, not {size}")
    shaped = is_linear(space)

    def stored(places: Floats) -> Floats:
        return unshape(places) if shaped else places

    def edited(places: Floats) -> Floats:
        values = stored(places)
        before = np.asarray(space.to_linear_srgb(values), dtype=np.float32)
        after = edit(before)
        result = np.array(values, dtype=np.float64)
        changed = (after != before).any(axis=1)
        result[changed] = space.from_linear_srgb(after[changed])
        return result

    side = np.linspace(0.0, 1.0, size)
    places = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3)
    table = edited(places).reshape(size, size, size, 3)
    if fit:
        moved = (table != stored(places).reshape(table.shape)).any(axis=-1)
        table = refit(table, moved, edited, _steepness if shaped else None)
    curve = shape(np.linspace(0.0, 1.0, SHAPER)).astype(np.float32) if shaped else None
    return Lut(table.astype(np.float32), curve)


def _steepness(values: Floats) -> Floats:
    """Lightness per linear value, nearly: errors of linear values are weighed by it."""
    return 1.0 / (np.maximum(values, 0.0) + 0.01) ** 0.6
