"""What layers of looks are made of: edits, as documents hold them and ready for a face."""

import abc
from typing import Protocol

from cutis.looks.document import Part
from cutis.maps import Face, Tile
from cutis.maps.plain import Map


class Effect(Protocol):
    """An edit that is ready for a face: takes a tile, and weights (h, W) of how much, where."""

    @property
    def reach(self) -> int:
        """Rows above and below a row that decide what becomes of it."""

    @property
    def trust(self) -> bool:
        """Whether it looks at σ or confidence."""

    def __call__(self, tile: Tile, weight: Map) -> Tile:
        """The tile changed, with one more count."""


class EditPart(Part, abc.ABC):
    """One edit of a layer."""

    @property
    @abc.abstractmethod
    def touches(self) -> frozenset[str]:
        """Names of the maps that it may change."""

    @property
    @abc.abstractmethod
    def reads(self) -> frozenset[str]:
        """Names of the maps of which it asks more than a texel's own values, before it starts."""

    @property
    @abc.abstractmethod
    def placed(self) -> bool:
        """Whether what becomes of a texel depends on its neighbours or on where it is."""

    @property
    @abc.abstractmethod
    def absolute(self) -> bool:
        """Whether its numbers are amounts of something, which mean what they say in one tissue."""

    @abc.abstractmethod
    def on_face(self, face: Face) -> Effect:
        """The edit ready for a face, which is as it stands before the edit."""

    @abc.abstractmethod
    def __str__(self) -> str:
        """What it does, as flags say it where they can."""
