"""Masks out of the maps themselves: where a map, its σ or the confidence lies in a range.

So moles, freckles, redness and lips are caught: where melanin is 1.5 times what is around, where
blood is above what 90 % of the face have.
"""

import re
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from cutis.errors import CutisError
from cutis.looks.blur import Blur
from cutis.looks.document import MapName, Radius, texels
from cutis.looks.edits import coordinates
from cutis.looks.folder import Folder
from cutis.looks.masks import Cover, MaskPart
from cutis.maps import Face, Tile
from cutis.maps.plain import Map
from cutis.optics import NAMES, parameter

PERCENTILE = r"^p(100|\d{1,2}(\.\d{1,2})?)$"
Level = (
    Annotated[float, Field(ge=-1e6, le=1e6)] | Annotated[str, Field(pattern=PERCENTILE)]
)  # fmt: skip
"""A number in the unit of what is looked at, or "p90": what 90 % of the face's skin are below."""
Ends = Level | tuple[Level, Level]
"""A hard end, or where a soft one starts and where it is over."""


class RangePart(MaskPart):
    """Where a map, its σ, or the confidence lies above, below, or between two levels."""

    part: Literal["range"] = "range"
    map: MapName | Literal["confidence"]
    of: Literal["value", "sigma"] = "value"
    over: Literal["nothing", "median", "local"] = Field(
        default="nothing",
        description="What the value is divided by: nothing, the face's median of the map, or a "
        "blur of `radius` around.",
    )
    areas: Literal["all", "large"] = Field(
        default="all", description="The map itself, or its large areas: blurred by `radius`."
    )
    radius: Radius | None = None
    above: Ends | None = Field(
        default=None, description="A level, or two: 0 below the first, 1 above the second."
    )
    below: Ends | None = Field(
        default=None, description="A level, or two: 1 below the first, 0 above the second."
    )

    @model_validator(mode="after")
    def _fits(self) -> "RangePart":
        if self.above is None and self.below is None:
            raise ValueError("a range needs above or below, or both")
        for name, ends in (("above", self.above), ("below", self.below)):
            _check_order(name, ends)
        blurred = self.over == "local" or self.areas == "large"
        if blurred != (self.radius is not None):
            raise ValueError(
                'a radius belongs to "over": "local" or "areas": "large", which need it'
            )
        if self.over == "local" and self.areas == "large":
            raise ValueError("large areas over what is local are 1 everywhere")
        plain = self.of == "value" and self.map in NAMES
        if not plain and (self.over != "nothing" or blurred):
            raise ValueError(f"only values of {', '.join(NAMES)} have a median and large areas")
        if self.of == "sigma" and self.map == "confidence":
            raise ValueError("confidence has no σ")
        relative = [one for one in _levels(self.above, self.below) if isinstance(one, str)]
        if relative and not (plain and self.over == "nothing"):
            raise ValueError(
                f"{relative[0]} is a percentile of the face, which values of {', '.join(NAMES)} "
                "have as they are"
            )
        return self

    @property
    def placed(self) -> bool:
        """Where it is blurred."""
        return self.radius is not None or self.feather is not None

    @property
    def absolute(self) -> bool:
        """Whether a level is an amount of something."""
        amounts = self.map != "confidence" and self.over == "nothing"
        return amounts and any(not isinstance(one, str) for one in _levels(self.above, self.below))

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The range on a face; CutisError where σ or confidence are looked at and not known."""
        looked_at = "confidence" if self.map == "confidence" else self.map
        trust = self.of == "sigma" or self.map == "confidence"
        if trust and not face.knows(looked_at):
            what = "confidence" if self.map == "confidence" else f"σ of {self.map}"
            raise CutisError(
                f"its mask looks at the {what}, which these maps do not have; estimate with a "
                "model that knows it, and without --no-sigma"
            )
        return _Range(self, face, trust)


class _Range(Cover):
    def __init__(self, part: RangePart, face: Face, trust: bool) -> None:
        self._part, self.trust = part, trust
        self._divide = np.float32(1)
        if part.over == "median":
            self._divide = np.float32(face.percentile(part.map, 0.5))
        self._above = None if part.above is None else self._ends(part.above, face)
        self._below = None if part.below is None else self._ends(part.below, face)
        self._blur: Blur | None = None
        if part.radius is not None:
            self._blur = Blur(texels(part.radius, face.shape), self._coordinates, face)
            self.reach, self.level = self._blur.reach, self._blur.level

    def _ends(self, ends: Ends, face: Face) -> tuple[np.float32, np.float32]:
        first, last = ends if isinstance(ends, tuple) else (ends, ends)
        low, high = (
            face.percentile(self._part.map, float(one[1:]) / 100) if isinstance(one, str) else one
            for one in (first, last)
        )
        return np.float32(low), np.float32(max(low, high))

    def _coordinates(self, tile: Tile) -> tuple[Map, Map]:
        inside = tile.maps.mask > 0
        values = coordinates(parameter(self._part.map), tile.maps[self._part.map], inside)
        return values, inside.astype(np.float32)

    def _values(self, tile: Tile) -> Map:
        part = self._part
        if part.map == "confidence":
            assert tile.confidence is not None
            return tile.confidence
        if part.of == "sigma":
            return tile.sigmas[part.map]
        values = tile.maps[part.map]
        if self._blur is None:
            return values / self._divide
        low = self._blur(*self._coordinates(tile), tile.maps.whole)
        large = np.asarray(parameter(part.map).from_coordinate(low), dtype=np.float32)
        if part.over == "local":
            return np.asarray(values / np.maximum(large, np.float32(1e-6)), np.float32)
        return np.asarray(large / self._divide, np.float32)

    def __call__(self, tile: Tile) -> Map:
        values = self._values(tile)
        cover = np.ones(values.shape, dtype=np.float32)
        if self._above is not None:
            cover *= _risen(values, *self._above)
        if self._below is not None:
            cover *= 1 - _risen(values, *self._below)
        return cover


def _risen(values: Map, low: np.float32, high: np.float32) -> Map:
    """0 up to `low`, 1 from `high` on, smooth between; a step where they are one."""
    if high <= low:
        return (values > low).astype(np.float32)
    t = np.clip((values - low) / (high - low), 0, 1)
    return np.asarray(t * t * (3 - 2 * t), dtype=np.float32)


def _levels(*ends: Ends | None) -> list[float | str]:
    found: list[float | str] = []
    for one in ends:
        if one is not None:
            found += one if isinstance(one, tuple) else (one,)
    return found


def _check_order(name: str, ends: Ends | None) -> None:
    if isinstance(ends, tuple) and len({type(one) for one in ends}) == 1:
        low, high = (float(re.sub("^p", "", str(one))) for one in ends)
        if low > high:
            raise ValueError(f"{name} goes from the lower level to the higher one")
