"""Edits as they are applied: where on a face, and how much of them.

What is applied to maps is a `Change`: it takes a tile of maps and gives it back changed, and says
how many rows beyond an edge it must see (`reach`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from cutis.errors import CutisError
from cutis.maps.edits import Edit
from cutis.maps.patches import patches
from cutis.maps.plain import Map, Maps


@dataclass(frozen=True, eq=False)
class Tile:
    """Maps with their σ by name, and how many texels each step pushed against an end of a range."""

    maps: Maps
    sigmas: Mapping[str, Map] = field(default_factory=dict)
    clamped: tuple[int, ...] = ()


class Change(Protocol):
    """Anything that maps can be changed by."""

    @property
    def reach(self) -> int:
        """Rows above and below a row that decide what becomes of it."""

    @property
    def told(self) -> tuple[str, ...]:
        """What it does, a line a step: as many as it adds to `Tile.clamped`."""

    def rows(self, rows: slice) -> "Change":
        """The same for some rows of the texture it was made for."""

    def __call__(self, tile: Tile) -> Tile:
        """The tile changed, its counts with those of this change behind them."""


class Painted(Protocol):
    """A mask that is read when it is needed: `textures.MaskFile`."""

    def rows(self, rows: slice) -> Map:
        """Values (h, W) in [0, 1] of some rows."""


@dataclass(frozen=True, eq=False)
class Step:
    """Edits in order, with one amount in [0, 1] and one painted mask `where` (H, W), 0–1.

    The mask is an array, or a file of which the rows are read that are worked on. It takes the
    place of procedural patches. Texels whose mask is 0 are never touched. Raises CutisError for
    amounts and masks out of range.
    """

    edits: tuple[Edit, ...]
    amount: float = 1.0
    where: Map | Painted | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.amount <= 1:
            raise CutisError(f"the amount of an edit must lie in 0 to 1, not {self.amount:g}")
        if isinstance(self.where, np.ndarray) and self.where.size:
            low, high = self.where.min(), self.where.max()
            if not (low >= 0 and high <= 1):  # NaN fails too
                raise CutisError("the edit mask must hold values from 0 to 1")

    @property
    def reach(self) -> int:
        """None of them looks at neighbours."""
        return 0

    @property
    def told(self) -> tuple[str, ...]:
        """Each edit with its amount, and whether a mask was painted."""
        how = f", amount {self.amount:g}" if self.amount < 1 else ""
        how += ", painted" if self.where is not None else ""
        return tuple(str(edit) + how for edit in self.edits)

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
        return Tile(maps, sigmas, (*tile.clamped, *counts))
