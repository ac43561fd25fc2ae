"""Which texels count."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.textures.closing import Closing
from cutis.textures.decoding import Decoder, check_finite
from cutis.textures.problem import problem
from cutis.textures.texture import bands, colour_channels, to_unit


class MaskFile(Closing):
    """An open mask, read some rows at a time; see `read_mask`, also for errors."""

    BLACK = 0.02
    """What JPEG may make of black: a mask that is nowhere lighter is empty."""

    def __init__(self, path: str | os.PathLike[str], shape: tuple[int, int]) -> None:
        self.path, self.shape = Path(path), shape
        self._source = Decoder(self.path)
        try:
            self._columns = self._found()
        except BaseException:
            self.close()
            raise

    def _found(self) -> list[int]:
        path, shape = self.path, self._source.shape
        if shape != tuple(self.shape):
            theirs, ours = (f"{width} × {height}" for height, width in (shape, self.shape))
            raise problem(path, f"the mask has {theirs} texels, the texture {ours}; resize it")
        names = [name.lower() for name in self._source.spec.channelnames]
        if "mask" in names:
            return [names.index("mask")]
        if len(names) < 3:
            return [0]
        try:
            return colour_channels(names)[0]
        except ValueError as error:
            raise problem(path, f"as a mask: {error}, or a channel called mask") from error

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """Values (h, W) in [0, 1] of some rows."""
        pixels = self._source.rows(rows)
        for column in self._columns:
            check_finite(
                self.path, pixels[..., column : column + 1], rows.indices(self.shape[0])[0]
            )
        return to_unit(pixels[..., self._columns]).mean(axis=-1).clip(0, 1)

    def empty(self) -> CutisError:
        """What to raise when no value was above BLACK."""
        return problem(self.path, "the mask is empty: all of it is black; paint white what counts")


def read_mask(path: str | os.PathLike[str], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Mask (H, W) in [0, 1] from a grey or colour image of `shape` (H, W).

    The channel called `mask` if there is one; else the mean of R, G, B; else, of one or two
    channels, the first. Stored values count as they are, over 255 or 65535 for integers, without
    a transfer function. Raises CutisError if the file is unreadable, of another size, or black.
    """
    with MaskFile(path, shape) as file:
        mask = np.empty(shape, np.float32)
        for rows in bands(shape):
            mask[rows] = file.rows(rows)
        if not (mask > MaskFile.BLACK).any():
            raise file.empty()
    return mask
