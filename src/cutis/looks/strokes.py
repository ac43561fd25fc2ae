"""Masks painted by hand: strokes of a round brush, which fit every resolution.

Of texels at distance d from the line of a stroke, a brush of radius r and hardness h covers

    1 − s((d − m) / w + 1/2),    m = r (1 + h) / 2,    w = r (1 − h),    s(t) = t² (3 − 2t),

all of it up to h r and nothing from r on; w is at least EDGE texels, so that hard edges are smooth.
Lines thinner than THIN texels are drawn as wide as that, and fainter. A stroke that crosses itself
covers no more there; strokes lie on each other, and an eraser takes away.
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from cutis.arrays import Map
from cutis.looks.document import Part, Share
from cutis.looks.folder import Folder
from cutis.looks.masks import Cover, MaskPart
from cutis.maps import Face, Tile
from cutis.textures.udim import FIRST, LAST

EDGE = 1.25
"""Texels over which a hard edge fades: about what a square texel averages over."""
THIN = 0.5
"""Texels of the smallest radius that is drawn as it is."""
MOST = 100_000
"""Points of all strokes of a part."""

Coordinate = Annotated[float, Field(ge=-1, le=2)]
Point = tuple[Coordinate, Coordinate]


class Stroke(Part):
    """A line of a round brush through points."""

    points: Annotated[tuple[Point, ...], Field(min_length=1, max_length=MOST)] = Field(
        description="[x, y]: fractions of the texture's width from the left and of its height "
        "from the top; a little outside is fine. One point is a dab."
    )
    radius: Annotated[float, Field(gt=0, le=1)] = Field(
        description="Of the brush: a fraction of the texture's longer side."
    )
    hardness: Share = Field(
        default=0.5, description="Share of the radius that is covered whole; 1 is a hard edge."
    )
    opacity: Share = 1.0
    erase: bool = Field(default=False, description="Takes away from the strokes before it.")
    tile: Annotated[int, Field(ge=FIRST, le=LAST)] = Field(
        default=FIRST, description="Of a UDIM set, the tile that it is on."
    )


class StrokesPart(MaskPart):
    """Strokes of a brush in the order in which they were painted."""

    part: Literal["strokes"] = "strokes"
    strokes: Annotated[tuple[Stroke, ...], Field(max_length=MOST)] = ()

    @model_validator(mode="after")
    def _not_too_many(self) -> "StrokesPart":
        count = sum(len(stroke.points) for stroke in self.strokes)
        if count > MOST:
            raise ValueError(
                f"its strokes have {count:,} points together, at most {MOST:,} are read; paint "
                "such a mask as a picture"
            )
        return self

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The strokes of this tile."""
        return _Strokes([one for one in self.strokes if one.tile == face.number], face.shape)


class _Strokes(Cover):
    def __init__(self, strokes: list[Stroke], shape: tuple[int, int]) -> None:
        height, width = shape
        counts = [len(stroke.points) for stroke in strokes]
        self._ends = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int64)
        points = [point for stroke in strokes for point in stroke.points]
        self._points = np.array(points, dtype=np.float64).reshape(-1, 2) * (width, height)
        self._brushes = np.array([_brush(one, max(shape)) for one in strokes]).reshape(-1, 4)

    def __call__(self, tile: Tile) -> Map:
        from cutis.looks.strokes_kernel import paint

        first = tile.maps.whole.first_row
        cover = np.zeros(tile.maps.shape, dtype=np.float32)
        paint(len(cover), first, self._points, self._ends, self._brushes, cover)
        return cover


def _brush(stroke: Stroke, longer: int) -> tuple[float, float, float, float]:
    """Middle and width of the edge in texels, opacity, and whether it erases."""
    asked = stroke.radius * longer
    radius = max(asked, THIN)
    middle, width = radius * (1 + stroke.hardness) / 2, radius * (1 - stroke.hardness)
    faint = asked / radius if len(stroke.points) > 1 else (asked / radius) ** 2
    return middle, max(width, EDGE), stroke.opacity * faint, float(stroke.erase)
