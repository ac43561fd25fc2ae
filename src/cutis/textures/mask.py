"""Which texels count."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.textures.decoding import check_finite, decode
from cutis.textures.problem import problem
from cutis.textures.texture import bands, colour_channels, to_unit

BLACK = 0.02
"""What JPEG may make of black: a mask that is nowhere lighter is empty."""


def read_mask(path: str | os.PathLike[str], shape: tuple[int, int]) -> NDArray[np.float32]:
    """Mask (H, W) in [0, 1] from a grey or colour image of `shape` (H, W).

    The channel called `mask` if there is one; else the mean of R, G, B; else, of one or two
    channels, the first. Stored values count as they are, over 255 or 65535 for integers, without
    a transfer function. Raises CutisError if the file is unreadable, of another size, or black.
    """
    path = Path(path)
    pixels, spec = (decoded := decode(path)).pixels, decoded.spec
    if pixels.shape[:2] != tuple(shape):
        theirs, ours = (f"{width} × {height}" for height, width in (pixels.shape[:2], shape))
        raise problem(path, f"the mask has {theirs} texels, the texture {ours}; resize the mask")
    names = [name.lower() for name in spec.channelnames]
    if "mask" in names:
        columns = [names.index("mask")]
    elif len(names) < 3:
        columns = [0]
    else:
        try:
            columns, _ = colour_channels(names)
        except ValueError as error:
            raise problem(path, f"as a mask: {error}, or a channel called mask") from error
    for column in columns:
        check_finite(path, pixels[..., column : column + 1])
    mask = np.empty(shape, np.float32)
    for rows in bands(shape):
        mask[rows] = to_unit(pixels[rows][..., columns]).mean(axis=-1).clip(0, 1)
    if not (mask > BLACK).any():
        raise problem(path, "the mask is empty: all of it is black; paint white what counts")
    return mask
