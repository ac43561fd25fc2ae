"""Layers of looks: edits with a name, an amount and a mask."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from cutis.errors import CutisError
from cutis.looks.document import Part, Share
from cutis.looks.edits import AnyEdit
from cutis.looks.effect import Effect
from cutis.looks.folder import Folder
from cutis.looks.masks import Mask, MaskPart, PaintedPart
from cutis.looks.pictures import GivenPart, PicturePart, RegionsPart
from cutis.looks.procedural import BlotchesPart, FrecklesPart, PatchesPart
from cutis.looks.ranges import RangePart
from cutis.looks.strokes import StrokesPart
from cutis.maps import Face, Tile
from cutis.maps.plain import Map

AnyMask = Annotated[
    PicturePart | RegionsPart | RangePart | StrokesPart | PatchesPart | BlotchesPart | FrecklesPart,
    Field(discriminator="part"),
]
"""Every kind of part that a mask may have. Another kind is one more class here."""
Text = Annotated[str, Field(max_length=10_000)]


GIVEN = (GivenPart, PaintedPart)
"""Parts that are in no document."""


class Layer(Part):
    """Edits in order, all with one amount, inside one mask."""

    name: Annotated[str, Field(max_length=200)] = ""
    note: Text = ""
    on: bool = True
    amount: Share = 1.0
    edits: Annotated[tuple[AnyEdit, ...], Field(max_length=1000)] = ()
    mask: Annotated[tuple[AnyMask, ...], Field(max_length=1000)] = Field(
        default=(), description="Parts in order; without any, the layer is everywhere."
    )

    def within(self, amount: float, part: MaskPart | None) -> "Layer":
        """So much less of it, inside one more part, which takes the place of procedural ones."""
        mask: tuple[Any, ...] = self.mask
        if part is not None:
            kept = tuple(one for one in mask if not one.stands_in)
            mask = (*kept, part.model_copy(update={"how": "intersect"}))
        return self.model_copy(update={"amount": self.amount * amount, "mask": mask})

    def moved(self, old: Path, new: Path) -> "Layer":
        """The same with the names of its files as seen from another folder."""
        mask = tuple(part.moved(old, new) for part in self.mask)
        return self.model_copy(update={"mask": mask})

    def without_painted(self) -> "Layer":
        """The same with masks that are not in the document by the names of their files."""
        mask = tuple(p.named() if isinstance(p, GIVEN) else p for p in self.mask)
        return self.model_copy(update={"mask": mask})

    def words(self) -> tuple[str, ...]:
        """What it does, a line for each edit."""
        how = f", amount {self.amount:g}" if self.amount < 1 else ""
        masked = [one for one in self.mask if not isinstance(one, GIVEN)]
        how += ", masked" if masked else ""
        how += ", painted" if len(masked) < len(self.mask) else ""
        start = f"{self.name}: " if self.name else ""
        return tuple(f"{start}{edit}{how}" for edit in self.edits)


class LayerOnFace:
    """A layer that is ready for a face: its mask, and as many of its edits as are."""

    def __init__(self, layer: Layer, face: Face, folder: Folder, label: str) -> None:
        """`face` is as its look finds it, since that is what masks look at."""
        self._amount, self._effects = layer.amount, list[Effect]()
        covers = []
        for number, part in enumerate(layer.mask, 1):
            try:
                covers.append(part.on_face(face, folder))
            except CutisError as error:
                raise CutisError(f"{label}, mask part {number}: {error}") from error
        self._mask = Mask(layer.mask, tuple(covers), face)

    def add(self, effect: Effect) -> None:
        """One more of its edits."""
        self._effects.append(effect)

    def first(self, count: int) -> "LayerOnFace":
        """The same with its first edits only."""
        part = object.__new__(LayerOnFace)
        part._amount, part._mask, part._effects = self._amount, self._mask, self._effects[:count]
        return part

    @property
    def reach(self) -> int:
        """Rows above and below a row that decide what becomes of it."""
        return self._mask.reach + sum(effect.reach for effect in self._effects)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was made of pictures."""
        return self._mask.notes

    @property
    def trust(self) -> bool:
        """Whether it looks at σ or confidence."""
        return self._mask.trust or any(effect.trust for effect in self._effects)

    def weight(self, tile: Tile) -> Map:
        """How much of the layer each texel (h, W) gets."""
        inside = tile.maps.mask > 0
        return np.where(inside, np.float32(self._amount) * self._mask(tile), np.float32(0))

    def __call__(self, start: Tile, tile: Tile) -> Tile:
        """The tile changed; `start` is what its look was given."""
        weight = self.weight(start)
        for effect in self._effects:
            tile = effect(tile, weight)
        return tile
