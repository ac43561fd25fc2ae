"""Edits as they are applied: where on a face, and how much of them.

What is applied to maps is a `Change`: it takes a tile of maps and gives it back changed, and says
how many rows beyond an edge it must see (`reach`). What people hold may have to be made ready
for a face first: it is a `Recipe`. A change is a recipe that is ready for any face.
"""

import abc
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from cutis.errors import CutisError
from cutis.maps.edits import Edit
from cutis.maps.patches import patches
from cutis.maps.plain import Map, Maps

if TYPE_CHECKING:
    from cutis.maps.face import Face


@dataclass(frozen=True, eq=False)
class Tile:
    """Maps with their σ by name, and how many texels each step pushed against an end of a range.

    `confidence` (H, W) is how likely each colour is one of skin. σ and confidence are there where
    they are known and wanted (`Change.trust`).
    """

    maps: Maps
    sigmas: Mapping[str, Map] = field(default_factory=dict)
    clamped: tuple[int, ...] = ()
    confidence: Map | None = None

    def rows(self, rows: slice) -> "Tile":
        """Some rows, with the counts of all."""
        sigmas = {name: values[rows] for name, values in self.sigmas.items()}
        sure = None if self.confidence is None else self.confidence[rows]
        return Tile(self.maps.rows(rows), sigmas, self.clamped, sure)


class Painted(Protocol):
    """A mask that is read when it is needed: `textures.MaskFile`."""

    def rows(self, rows: slice) -> Map:
        """Values (h, W) in [0, 1] of some rows."""


class Recipe(abc.ABC):
    """Edits as people hold them, for any face."""

    @abc.abstractmethod
    def for_face(self, face: "Face") -> "Change":
        """The change that these edits are on a face; CutisError where they do not fit it."""

    @abc.abstractmethod
    def within(self, amount: float, where: Map | Painted | None = None) -> "Recipe":
        """So much of it, in [0, 1], inside a painted mask (H, W), 0–1.

        The mask takes the place of procedural ones. Raises CutisError for amounts and masks out of
        range.
        """

    @abc.abstractmethod
    def check_everywhere(self) -> None:
        """CutisError where what becomes of a texel depends on where it is or on its neighbours."""

    @property
    def documents(self) -> tuple[str, ...]:
        """What headers of maps keep to do it again: looks, as JSON."""
        return ()


class Change(Recipe):
    """Anything that maps can be changed by."""

    @property
    def reach(self) -> int:
        """Rows above and below a row that decide what becomes of it."""
        return 0

    @property
    def notes(self) -> tuple[str, ...]:
        """What was made of files that can be understood in several ways, in words."""
        return ()

    @property
    def trust(self) -> bool:
        """Whether it looks at σ or confidence."""
        return False

    @property
    @abc.abstractmethod
    def told(self) -> tuple[str, ...]:
        """What it does, a line a step: as many as it adds to `Tile.clamped`."""

    @property
    @abc.abstractmethod
    def touches(self) -> frozenset[str]:
        """Names of the maps that it may change."""

    @abc.abstractmethod
    def __call__(self, tile: Tile) -> Tile:
        """The tile changed, its counts with those of this change behind them."""

    def rows(self, rows: slice) -> "Change":
        """The same for some rows of the texture it was made for."""
        return self

    def for_face(self, face: "Face") -> "Change":
        """Itself."""
        return self

    def check_everywhere(self) -> None:
        """CutisError where it looks at neighbours."""
        if self.reach:
            raise CutisError(f"{self.told[0]}: it looks at neighbours, which a LUT cannot")

    def within(self, amount: float, where: Map | Painted | None = None) -> Recipe:
        """Itself, where that is all of it everywhere."""
        if where is not None or amount != 1:
            raise CutisError("a change of its own brings its amount and masks with it")
        return self


Edits = Edit | Sequence[Edit] | Recipe
"""What may be done to maps: one edit, some in order, a look, a change."""


def recipe(edits: Edits) -> Recipe:
    """Edits of any kind as a recipe."""
    if isinstance(edits, Recipe):
        return edits
    return Step((edits,) if isinstance(edits, Edit) else tuple(edits))


@dataclass(frozen=True, eq=False)
class Step(Change):
    """Edits in order, with one amount in [0, 1] and one painted mask `where` (H, W), 0–1.

    The mask is an array, or a file of which the rows are read that are worked on. It takes the
    place of procedural patches. Texels whose mask is 0 are never touched. Raises CutisError for
    amounts and masks out of range.
    """

    edits: tuple[Edit, ...]
    amount: float = 1.0
    where: Map | Painted | None = None

    def __post_init__(self) -> None:
        _share(self.amount)
        if isinstance(self.where, np.ndarray) and self.where.size:
            low, high = self.where.min(), self.where.max()
            if not (low >= 0 and high <= 1):  # NaN fails too
                raise CutisError("the edit mask must hold values from 0 to 1")

    @property
    def told(self) -> tuple[str, ...]:
        """Each edit with its amount, and whether a mask was painted."""
        how = f", amount {self.amount:g}" if self.amount < 1 else ""
        how += ", painted" if self.where is not None else ""
        return tuple(str(edit) + how for edit in self.edits)

    @property
    def touches(self) -> frozenset[str]:
        """The maps that are edited."""
        return frozenset(edit.parameter for edit in self.edits)

    def check_everywhere(self) -> None:
        """CutisError where there is a mask, patches, or an amount for each texel."""
        for edit in self.edits:
            if isinstance(edit.amount, np.ndarray):
                raise CutisError(f"{edit}: a LUT cannot tell places apart; give one amount for all")
            if self.where is not None or edit.where != "everywhere":
                raise CutisError(f"{edit}: a LUT cannot tell places apart; leave this edit out")

    def within(self, amount: float, where: Map | Painted | None = None) -> "Step":
        """The same, so much less of it, or inside a mask; `Recipe`."""
        if where is None:
            return replace(self, amount=_share(amount) * self.amount)
        if self.where is not None:
            raise CutisError("a change of its own brings its amount and masks with it")
        return replace(self, amount=_share(amount) * self.amount, where=where)

    def rows(self, rows: slice) -> "Step":
        """The same for some rows."""
        edits, where = tuple(edit.rows(rows) for edit in self.edits), self.where
        if where is not None:
            where = where[rows] if isinstance(where, np.ndarray) else where.rows(rows)
        return replace(self, edits=edits, where=where)

    def __call__(self, tile: Tile) -> Tile:
        """Applies the edits in order; `Change`."""
        maps, sigmas = tile.maps, dict(tile.sigmas)
        inside = (maps.mask > 0).astype(np.float32)
        if self.where is not None:
            whole = slice(0, maps.shape[0])
            where = self.where if isinstance(self.where, np.ndarray) else self.where.rows(whole)
            if where.shape != maps.shape:
                raise CutisError(f"the edit mask is {where.shape}, the maps are {maps.shape}")
            inside = where * inside
        everywhere = np.float32(self.amount) * inside
        counts = []
        for edit in self.edits:
            weight = everywhere
            if self.where is None and edit.where == "patches":
                at = maps.whole
                rows = slice(at.first_row, at.first_row + maps.shape[0])
                weight = everywhere * patches(at.whole, rows)
            name = edit.parameter
            edited, clamped = edit(maps[name], weight)
            maps = maps.with_values({name: edited})
            if name in sigmas:
                sigmas[name] = edit.sigma(sigmas[name], weight)
            counts.append(clamped)
        return Tile(maps, sigmas, (*tile.clamped, *counts), tile.confidence)


def _share(amount: float) -> float:
    if not 0 <= amount <= 1:
        raise CutisError(f"the amount of an edit must lie in 0 to 1, not {amount:g}")
    return amount
