"""Masks that grow by themselves: patches and blotches."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from cutis.looks.folder import Folder
from cutis.looks.masks import Cover, MaskPart
from cutis.maps import Face, Tile
from cutis.maps.patches import patches
from cutis.maps.plain import Map
from cutis.textures.udim import FIRST

Seed = Annotated[int, Field(ge=0, le=2**31)]


class PatchesPart(MaskPart):
    """Irregular patches with soft edges over a third of the skin, as vitiligo has them."""

    procedural: ClassVar[bool] = True

    part: Literal["patches"] = "patches"
    seed: Seed = 7

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The patches of this tile."""
        return _Patches(tile_seed(self.seed, face))


class _Patches(Cover):
    def __init__(self, seed: int) -> None:
        self._seed = seed

    def __call__(self, tile: Tile) -> Map:
        at = tile.maps.whole
        rows = slice(at.first_row, at.first_row + tile.maps.shape[0])
        return patches(at.whole, rows, self._seed)


def tile_seed(seed: int, face: Face) -> int:
    """Of a tile, so that tiles of one set differ; that of tile 1001 is the seed itself."""
    return seed + 1_000_003 * (face.number - FIRST)
