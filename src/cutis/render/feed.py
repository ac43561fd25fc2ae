"""Textures handed to a renderer: linear half OpenEXR, reduced to what a picture can show."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import LINEAR
from cutis.maps import Change
from cutis.render.skin import Rows, Skin
from cutis.textures import Frame, Texture, bands, texture_writer

LONGEST = 4096
"""Texels along the longer side; a 16k texture as Blender holds it would take 4 GB."""


@dataclass(frozen=True)
class _Reduced:
    """The texture to be, of `shape`."""

    shape: tuple[int, int]

    @property
    def frame(self) -> Frame:
        """All of its picture."""
        return Frame(self.shape, self.shape)

    def rows(self, rows: slice) -> Texture:
        count = len(range(*rows.indices(self.shape[0])))
        return _texture(np.zeros((count, self.shape[1], 3), np.float32))


def write_feed(
    skin: Skin,
    path: Path,
    convert: Callable[[Rows], NDArray[np.floating]],
    changes: Sequence[Change] = (),
    longest: int = LONGEST,
) -> None:
    """Writes what `convert` makes of the skin's rows, (h, W, 3), as an EXR for a renderer.

    Textures of more than `longest` texels a side become means over squares of texels.
    """
    height, width = skin.shape
    step = -(-max(skin.shape) // longest)
    like = _Reduced((max(height // step, 1), max(width // step, 1)))
    with texture_writer(path, like) as writer:
        for rows in bands(skin.shape, step):
            colours = np.asarray(convert(skin.rows(rows, changes)), np.float32)
            writer.write(_texture(_means(colours, step)))


def _means(values: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """Means over squares of `step` texels; what is left over at the edges is left out."""
    if step == 1:
        return values
    height, width = (n // step for n in values.shape[:2])
    blocks = values[: height * step, : width * step].reshape(height, step, width, step, 3)
    return np.asarray(blocks.mean(axis=(1, 3)), dtype=np.float32)


def _texture(values: NDArray[np.float32]) -> Texture:
    return Texture(values.astype(np.float16), ("R", "G", "B"), LINEAR)
