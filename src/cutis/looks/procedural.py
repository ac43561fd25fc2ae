"""Masks that grow by themselves: patches, blotches and freckles."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from cutis.arrays import Map
from cutis.looks.document import Share
from cutis.looks.folder import Folder
from cutis.looks.freckles import freckles
from cutis.looks.masks import Cover, MaskPart
from cutis.maps import Face, Tile
from cutis.maps.patches import COVERAGE, EDGE, OCTAVES, SIZE, patches
from cutis.textures.udim import FIRST

SMOOTH = 3
"""Scales of blotches: rounder than patches."""
Seed = Annotated[int, Field(ge=0, le=2**31)]


class PatchesPart(MaskPart):
    """Irregular patches with soft edges over a third of the skin, as vitiligo has them."""

    procedural: ClassVar[bool] = True

    part: Literal["patches"] = "patches"
    seed: Seed = 7

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The patches of this tile."""
        return _Blotches(tile_seed(self.seed, face))


class BlotchesPart(MaskPart):
    """Irregular soft areas, as redness and uneven colour lie on skin."""

    part: Literal["blotches"] = "blotches"
    size: Annotated[float, Field(ge=0.005, le=0.5)] = Field(
        default=0.06, description="Of the largest: a fraction of the texture's longer side."
    )
    density: Annotated[float, Field(gt=0, lt=1)] = Field(
        default=0.35, description="Share of the texture inside them."
    )
    soft: Annotated[float, Field(ge=0.02, le=4)] = Field(
        default=1.0, description="Width of their edges: 0.1 is an outline, 2 a gentle drift."
    )
    seed: Seed = 1
    stand_in: bool = Field(default=False, description="A painted mask takes its place.")

    @property
    def stands_in(self) -> bool:
        """Whether a painted mask takes its place."""
        return self.stand_in

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The blotches of this tile."""
        how = (self.size, self.density, self.soft, SMOOTH)
        return _Blotches(tile_seed(self.seed, face), how)


class FrecklesPart(MaskPart):
    """Small spots of many sizes and strengths, in clusters.

    People have them where the sun reaches: intersect them with strokes over cheeks and nose, or
    with a range, such as large areas of blood above "p50".
    """

    part: Literal["freckles"] = "freckles"
    size: Annotated[float, Field(ge=0.0003, le=0.05)] = Field(
        default=0.003, description="Median radius: a fraction of the texture's longer side."
    )
    density: Annotated[float, Field(gt=0, le=0.7)] = Field(
        default=0.12, description="Share of the area that they cover where they are densest."
    )
    clustered: Share = Field(
        default=0.8, description="0 strews them evenly, 1 leaves none between clusters."
    )
    soft: Share = Field(default=0.7, description="Share of the radius that is edge.")
    seed: Seed = 1

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The freckles of this tile."""
        seed = tile_seed(self.seed, face)
        return freckles(face.shape, self.size, self.density, self.clustered, self.soft, seed)


class _Blotches(Cover):
    def __init__(
        self, seed: int, how: tuple[float, float, float, int] = (SIZE, COVERAGE, EDGE, OCTAVES)
    ) -> None:
        self._seed, self._how = seed, how

    def __call__(self, tile: Tile) -> Map:
        at = tile.maps.whole
        rows = slice(at.first_row, at.first_row + tile.maps.shape[0])
        return patches(at.whole, rows, self._seed, *self._how)


def tile_seed(seed: int, face: Face) -> int:
    """Of a tile, so that tiles of one set differ; that of tile 1001 is the seed itself."""
    return seed + 1_000_003 * (face.number - FIRST)
