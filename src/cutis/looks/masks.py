"""Masks of layers: parts that add to each other, take away, or narrow, with inverse and feather.

Parts are coverages a, b in [0, 1] and go together as those of independent layers do: added they
give 1 − (1 − a)(1 − b), subtracted a (1 − b), intersected a b. A mask whose first part adds starts
from nothing, any other from everything.
"""

import abc
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from cutis.errors import CutisError
from cutis.looks.blur import Blur
from cutis.looks.document import Part, Radius, texels
from cutis.looks.folder import Folder
from cutis.looks.window import Window
from cutis.maps import Face, Tile
from cutis.maps.plain import Map


class Cover(abc.ABC):
    """A mask that is ready for a face: takes a tile and says how much of it counts, (h, W).

    `reach` is how many rows above and below decide what it is, `level` how many looks
    at the whole it needs, one after the other (`Face.ask`), `trust` whether it looks at σ or
    confidence, `notes` what was made of its file.
    """

    reach: int = 0
    level: int = 0
    trust: bool = False
    notes: tuple[str, ...] = ()

    @abc.abstractmethod
    def __call__(self, tile: Tile) -> Map:
        """Values in [0, 1]."""


class MaskPart(Part, abc.ABC):
    """One part of a mask."""

    how: Literal["add", "subtract", "intersect"] = Field(
        default="add", description="What it does to the parts above it."
    )
    invert: bool = False
    feather: Radius | None = Field(default=None, description="How far its edges are blurred.")

    procedural: ClassVar[bool] = False
    """Whether a painted mask takes its place."""

    @abc.abstractmethod
    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The part without inverse and feather, ready for a face as its look finds it."""

    def files(self, folder: Folder) -> tuple[Path, ...]:
        """Files that decide what it is, or patterns of them with <UDIM>."""
        return ()

    def check_names(self, folder: Folder) -> None:
        """CutisError where it names files that it may not; opens none."""

    def moved(self, old: Path, new: Path) -> "MaskPart":
        """The same with the names of its files as seen from another folder."""
        return self

    @property
    def stands_in(self) -> bool:
        """Whether a painted mask takes its place."""
        return self.procedural

    @property
    def placed(self) -> bool:
        """Whether it depends on where a texel is or on its neighbours, as all but ranges do."""
        return True

    @property
    def absolute(self) -> bool:
        """Whether it has numbers of amounts, which mean what they say in one tissue."""
        return False


class Mask(Cover):
    """All parts of a mask together, ready for a face."""

    def __init__(self, parts: tuple[MaskPart, ...], covers: tuple[Cover, ...], face: Face) -> None:
        self._parts = parts
        self._covers = tuple(
            cover if part.feather is None else Feathered(cover, part, face)
            for part, cover in zip(parts, covers, strict=True)
        )
        self.reach = max((cover.reach for cover in self._covers), default=0)
        self.trust = any(cover.trust for cover in self._covers)
        self.notes = tuple(note for cover in covers for note in cover.notes)

    def __call__(self, tile: Tile) -> Map:
        """Values (h, W) in [0, 1]."""
        started = bool(self._parts) and self._parts[0].how == "add"
        total = np.full(tile.maps.shape, 0 if started else 1, dtype=np.float32)
        for part, cover in zip(self._parts, self._covers, strict=True):
            values = cover(tile)
            if part.invert:
                values = 1 - values
            if part.how == "add":
                total = 1 - (1 - total) * (1 - values)
            else:
                total = total * (values if part.how == "intersect" else 1 - values)
        return total


class Feathered(Cover):
    """A part with blurred edges."""

    def __init__(self, cover: Cover, part: MaskPart, face: Face) -> None:
        assert part.feather is not None

        def field(tile: Tile) -> tuple[Map, Map]:
            return cover(tile), np.ones(tile.maps.shape, dtype=np.float32)

        self._field, self.trust = field, cover.trust
        sigma = texels(part.feather, face.shape)
        self._blur = Blur(sigma, field, face, cover.level, cover.trust)
        self.reach, self.level = cover.reach + self._blur.reach, self._blur.level

    def __call__(self, tile: Tile) -> Map:
        """Values (h, W) in [0, 1]."""
        values, weights = self._field(tile)
        return np.clip(self._blur(values, weights, tile.maps.whole), 0, 1)


# parts that come from elsewhere than the document ------------------------------------------------


class PaintedPart(MaskPart):
    """A mask in memory that no document can hold."""

    part: Literal["painted"] = "painted"
    painted: Any

    def __eq__(self, other: object) -> bool:
        """Only to itself."""
        return self is other

    def __hash__(self) -> int:
        """Its identity."""
        return id(self)

    def named(self) -> MaskPart:
        """What a header keeps of it."""
        return NamedPart(how=self.how, file="")

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The mask, of the whole texture."""
        return _Painted(self.painted)


class NamedPart(MaskPart):
    """A painted mask of which a header keeps that there was one, and its name."""

    part: Literal["painted"] = "painted"
    file: str

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """Raises CutisError: it is not kept."""
        raise CutisError("a painted mask is not kept with the maps; give it with --mask")


class _Painted(Cover):
    def __init__(self, painted: Any) -> None:
        array = isinstance(painted, np.ndarray)
        self._window = Window(painted.__getitem__ if array else painted.rows)

    def __call__(self, tile: Tile) -> Map:
        first = tile.maps.whole.first_row
        return self._window.rows(first, first + tile.maps.shape[0])
