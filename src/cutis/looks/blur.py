"""Large areas and detail: Gaussian blurs that are the same in one piece and in bands.

A blur of few texels folds the rows with a Gaussian cut at 3.5 standard deviations and says how far
it reaches. One of many looks at the whole texture first: means over squares of texels, anchored at
its corner, are blurred and drawn large again by cubic B-splines, whose spread and that of the
squares is taken off the Gaussian's. Then no row needs its neighbours, and 1/16 of the texels or
fewer are held. Masked texels are left out of all sums.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.maps import Face, Tile
from cutis.maps.plain import Map, Place

FEW = 8.0
"""Texels of a standard deviation from which on the whole texture is looked at first."""
CUT = 3.5
"""Standard deviations at which a Gaussian is cut."""

Field = Callable[[Tile], tuple[Map, Map]]
"""From a tile to values (h, W) and their weights (h, W), 0 where they are left out."""


class Blur:
    """A field blurred by a Gaussian of `sigma` texels, over the texture of a face.

    `reach` is how many rows above and below decide what becomes of a row.
    """

    def __init__(self, sigma: float, field: Field, face: Face, trust: bool = False) -> None:
        """`face` is as it stands where the field is taken; `trust`: the field looks at σ."""
        from cutis.looks.blur_kernel import add_up

        self.step = 1 if sigma < FEW else int(2 ** np.floor(np.log2(sigma / 2)))
        self._taps, self.reach = taps(sigma), 0
        if self.step == 1:
            self.reach = len(self._taps) // 2
            return
        shape = tuple(-(-side // self.step) for side in face.shape)
        sums, counts = np.zeros(shape), np.zeros(shape)
        for rows, skin in face.bands(trust):
            values, weights = field(tile_of(skin))
            add_up(values, weights, rows.start, self.step, sums, counts)
        # variances, in squares: of n texels (1 - 1/n²) / 12, of a cubic B-spline 1/3
        left = (sigma / self.step) ** 2 - (1 - self.step**-2) / 12 - 1 / 3
        narrow = taps(left**0.5)
        self._sums, self._counts = (_folded(grid.astype(np.float32), narrow)
                                    for grid in (sums, counts))  # fmt: skip

    def __call__(self, values: Map, weights: Map, at: Place) -> Map:
        """The blurred values (h, W) of some rows, their own where nothing is near."""
        if self.step == 1:
            masked = np.where(weights > 0, values * weights, np.float32(0))
            share = _folded(weights, self._taps)
            with np.errstate(invalid="ignore"):
                out = _folded(masked, self._taps) / share
        else:
            from cutis.looks.blur_kernel import drawn_large

            out = np.empty_like(values)
            drawn_large(len(values), self._sums, self._counts, at.first_row, self.step, out)
        return np.where(np.isfinite(out), out, values)


def taps(sigma: float) -> NDArray[np.float32]:
    """Weights (2 r + 1,) of a Gaussian, sum 1."""
    reach = int(np.ceil(CUT * sigma))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.asarray(weights / weights.sum(), dtype=np.float32)


def _folded(values: Map, weights: NDArray[np.float32]) -> Map:
    from cutis.looks.blur_kernel import along_columns, along_rows

    values = np.ascontiguousarray(values, dtype=np.float32)
    first, second = np.empty_like(values), np.empty_like(values)
    along_rows(len(values), values, weights, first)
    along_columns(len(values), first, weights, second)
    return second


def tile_of(skin: Any) -> Tile:
    """Maps as changes see them."""
    return Tile(skin.maps, skin.sigmas, (), skin.confidence)
