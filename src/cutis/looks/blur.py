"""Large areas and detail: Gaussian blurs that are the same in one piece and in bands.

A blur of few texels folds the rows with a Gaussian cut at 3.5 standard deviations and says how far
it reaches. One of many looks at the whole texture first: means over squares of texels, anchored at
its corner, are blurred and drawn large again by cubic B-splines, whose spread and that of the
squares is taken off the Gaussian's. Then no row needs its neighbours, and 1/16 of the texels or
fewer are held. Masked texels are left out of all sums.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cutis.arrays import Map
from cutis.maps import Face, SkinMaps, Tile
from cutis.maps.plain import Place

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

    def __init__(
        self, sigma: float, field: Field, face: Face, level: int = 0, trust: bool = False
    ) -> None:
        """`face` is as it stands where the field is taken.

        `level` is that of what the field needs to have seen first, `trust`: it looks at σ.
        """
        self.step = 1 if sigma < FEW else int(2 ** np.floor(np.log2(sigma / 2)))
        self._taps, self._face = taps(sigma), face
        self.reach, self.level = len(self._taps) // 2, level
        self._grids: tuple[Map, Map] | None = None
        if self.step > 1:
            self.reach, self.level = 0, level + 1
            # variances, in squares: of n texels (1 - 1/n²) / 12, of a cubic B-spline 1/3
            left = (sigma / self.step) ** 2 - (1 - self.step**-2) / 12 - 1 / 3
            self._taps = taps(left**0.5)
            shape = tuple(-(-side // self.step) for side in face.shape)
            self._sums, self._counts = np.zeros(shape), np.zeros(shape)
            self._field = field
            face.ask(self._see, self.level, trust)

    def _see(self, rows: slice, skin: SkinMaps) -> None:
        from cutis.looks.blur_kernel import add_up

        values, weights = self._field(tile_of(skin))
        add_up(values, weights, rows.start, self.step, self._sums, self._counts)

    def _seen(self) -> tuple[Map, Map]:
        """Blurred sums and counts of squares of texels."""
        if self._grids is None:
            self._face.settle()
            both = (grid.astype(np.float32) for grid in (self._sums, self._counts))
            sums, counts = (_folded(grid, self._taps) for grid in both)
            self._grids = sums, counts
        return self._grids

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
            drawn_large(len(values), *self._seen(), at.first_row, self.step, out)
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


def tile_of(skin: SkinMaps) -> Tile:
    """Maps as changes see them."""
    return Tile(skin.maps, skin.sigmas, (), skin.confidence)
