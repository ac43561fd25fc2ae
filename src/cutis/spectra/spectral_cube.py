"""What is common to hyperspectral cubes: wavelengths, and values some rows at a time."""

from abc import abstractmethod
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.textures.closing import Closing
from cutis.textures.limits import check_size

TEXELS = 1 << 15
"""Texels, about, that `bands` takes at a time."""


class SpectralCube(Closing):
    """An open cube of `shape` (H, W) texels at `wavelengths` (n,), nm.

    `notes` say what was assumed; `scale` is the stored value that means a reflectance of 1 where
    the file says so. Values are as stored, NaN where the file says that there is none.
    """

    path: Path
    shape: tuple[int, int]
    wavelengths: NDArray[np.float64]
    notes: list[str]
    scale: float | None = None

    @abstractmethod
    def rows(self, rows: slice) -> NDArray[np.float32]:
        """(h, W, n) values of some rows."""

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the cube, of about TEXELS texels each."""
        step = max(1, TEXELS // self.shape[1])
        for top in range(0, self.shape[0], step):
            yield slice(top, min(top + step, self.shape[0]))

    def sample(self) -> NDArray[np.float32]:
        """Values of some rows spread over the cube."""
        rows = np.unique(np.linspace(0, self.shape[0] - 1, 9).astype(int))
        return np.concatenate([self.rows(slice(row, row + 1)) for row in rows])

    def _check(self) -> None:
        height, width = self.shape
        check_size(self.path, width, height)
