"""A whole face, as changes ask about it before they are applied to rows.

A face is a texture, or all tiles of a UDIM set. What is taken of all of it, medians first, must not
depend on which rows or tiles are at hand: it comes from what headers keep, or from a look at
everything.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from cutis.errors import CutisError
from cutis.maps.changes import Change, Recipe
from cutis.maps.source import orientation_of
from cutis.maps.statistics import MapStatistics, Quantiles
from cutis.textures import Frame, Orientation
from cutis.textures.frame import noted_frame
from cutis.textures.texture import bands
from cutis.textures.udim import FIRST

if TYPE_CHECKING:
    from cutis.maps.skin_maps import MadeBy, SkinMaps


@dataclass(frozen=True)
class TileOf:
    """Which tile of a UDIM set maps are of, and the files of maps of all its tiles by number.

    `read` opens one of them. What is of no set is tile 1001, and has no files.
    """

    number: int = FIRST
    files: Mapping[int, Path] = field(default_factory=dict)
    read: "Callable[[Path], AbstractContextManager[Source]] | None" = None


class Source(Protocol):
    """Maps of a texture as they are before changes, in memory or in a file."""

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""

    @property
    def tile(self) -> TileOf:
        """Which tile it is."""

    @property
    def made_by(self) -> "MadeBy":
        """The model."""

    @property
    def known(self) -> Quantiles | None:
        """Where the values of its maps lie, as far as somebody has looked."""

    @property
    def provenance(self) -> Mapping[str, str]:
        """Where the maps are from."""

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it."""

    def rows(self, rows: slice, trust: bool = True) -> "SkinMaps":
        """Maps of some rows, with their capture where that is at hand."""

    def keep(self) -> None:
        """Says that rows will be asked for again."""


See = Callable[[slice, "SkinMaps"], None]
"""Takes rows, and their maps."""
Memo = dict[tuple[Any, ...], tuple[Any, Any]]
"""What was found of a face with something done to it: what that is of, so that its identity does
not come again, and the finding."""
Found = TypeVar("Found")


class Face:
    """A texture with what was done to it, and the set that it is of.

    `done` are the recipes that were applied in order. `memo` keeps what was found of a whole set:
    give one to all faces of a set that are looked at in turn.
    """

    def __init__(
        self,
        source: Source,
        done: Sequence[Recipe] = (),
        changes: Sequence[Change] | None = None,
        memo: Memo | None = None,
        progress: Callable[[int, int, str], None] = lambda done, total, doing: None,
    ) -> None:
        """`changes` is what `done` are on this face, if somebody has made them already."""
        self._source, self._done = source, tuple(done)
        self._given = None if changes is None else tuple(changes)
        self._memo: Memo = {} if memo is None else memo
        self._asked: list[tuple[int, bool, See]] = []
        self._progress = progress

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of this tile in texels."""
        return self._source.shape

    @property
    def number(self) -> int:
        """Of this tile: 1001 where there is no set."""
        return self._source.tile.number

    @property
    def made_by(self) -> "MadeBy":
        """The model of the maps."""
        return self._source.made_by

    @property
    def frame(self) -> Frame:
        """Where its texels lie on the picture that the capture is of."""
        return noted_frame(self._source.provenance.get("window", ""), self.shape)

    @property
    def orientation(self) -> Orientation:
        """How the capture was turned, and pictures that go with it are."""
        return orientation_of(self._source.provenance)

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""
        return self._source.knows(name)

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """What was done, ready for this tile."""
        return bound(self._done, self.before()) if self._given is None else self._given

    def before(self, count: int = 0) -> "Face":
        """The same after the first `count` of the recipes only."""
        given = None if self._given is None else self._given[:count]
        return Face(self._source, self._done[:count], given, self._memo, self._progress)

    def after(self, recipe: Recipe, change: Change) -> "Face":
        """The same with one more recipe applied, which is `change` here."""
        done, changes = (*self._done, recipe), (*self.changes, change)
        return Face(self._source, done, changes, self._memo, self._progress)

    def bands(self, trust: bool = False) -> Iterator[tuple[slice, "SkinMaps"]]:
        """All rows of this tile as they stand, from top to bottom."""
        for rows in self._source.bands():
            yield rows, edited(self._source, rows, self.changes, trust)

    def ask(self, see: See, level: int = 1, trust: bool = False) -> None:
        """Has `see` shown all rows of this tile as they stand, before `settle` is over.

        Those of one level are shown a row together, and may need what lower levels have seen.
        `trust`: σ and confidence must be there.
        """
        self._asked.append((level, trust, see))

    def settle(self) -> None:
        """Shows all rows to whom they are still to be shown."""
        while self._asked:
            level = min(level for level, _, _ in self._asked)
            now = [one for one in self._asked if one[0] == level]
            self._asked = [one for one in self._asked if one[0] != level]
            self._source.keep()
            height, width = self.shape
            for rows, skin in self.bands(any(trust for _, trust, _ in now)):
                for _, _, see in now:
                    see(rows, skin)
                self._progress(min(rows.stop, height) * width, height * width, "looking at it all")

    @contextlib.contextmanager
    def opened(self, number: int) -> Iterator["Face"]:
        """Another tile of the set, with the same done to it; CutisError where its file is gone."""
        if number == self.number:
            yield self
            return
        path, read = self._source.tile.files[number], self._source.tile.read
        if read is None or not path.is_file():
            raise CutisError(
                f"{path}: is a tile of the same face and is not there; put it beside the others, "
                "since looks take medians over all tiles"
            )
        with read(path) as file:
            yield Face(file, self._done, None, self._memo, self._progress)

    @property
    def tiles(self) -> tuple[int, ...]:
        """Numbers of all tiles of the set, in order."""
        return tuple(sorted({self.number, *self._source.tile.files}))

    def percentile(self, name: str, share: float) -> float:
        """The value of a map as it stands below which a share, 0–1, of the whole set's skin lies.

        One of the five, in its unit. Masked texels count, however sure they are.
        """
        count = len(self._done)
        while count and name not in self.changes[count - 1].touches:
            count -= 1
        return self.before(count)._quantiles().percentile(name, share)

    def once(self, owner: object, name: str, find: Callable[[], Found]) -> Found:
        """What `find` gives, worked out only once for all tiles of a set as they stand.

        `owner` and `name` say what it is.
        """
        key = (*map(id, self._done), id(owner), name)
        if key not in self._memo:
            self._memo[key] = (self._done, owner), find()
        result: Found = self._memo[key][1]
        return result

    def over_set(
        self, owner: object, name: str, find: Callable[["Face"], Found]
    ) -> tuple[Found, ...]:
        """What `find` gives of each tile of the set, in order; worked out only once."""

        def all_tiles() -> tuple[Found, ...]:
            found = []
            for number in self.tiles:
                with self.opened(number) as face:
                    found.append(find(face))
            return tuple(found)

        return self.once(owner, name, all_tiles)

    def _quantiles(self) -> Quantiles:
        def together() -> Quantiles:
            return Quantiles.together(self.over_set(None, "quantiles", Face._own))

        return self.once(None, "all quantiles", together)

    def _own(self) -> Quantiles:
        known = self._source.known
        if known is not None and not self._done:
            return known
        found = MapStatistics()
        for _, skin in self.bands():
            found.add(skin.coordinates(), skin.mask > 0)
        return found.quantiles()


def bound(recipes: Sequence[Recipe], face: Face) -> tuple[Change, ...]:
    """What recipes are on a face, one after the other."""
    found: list[Change] = []
    for recipe in recipes:
        change = recipe.for_face(face)
        found.append(change)
        face = face.after(recipe, change)
    return tuple(found)


def edited(
    source: Source, rows: slice, changes: Sequence[Change], trust: bool = True
) -> "SkinMaps":
    """Maps of some rows with changes of the whole texture applied.

    Changes that look further see so much more. Without `trust` σ and confidence are there only
    where a change looks at them.
    """
    height = source.shape[0]
    start, stop, _ = rows.indices(height)
    reach = sum(change.reach for change in changes)
    wide = slice(max(0, start - reach), min(height, stop + reach))
    part = source.rows(wide, trust or any(change.trust for change in changes))
    for change in changes:
        part = part.changed_by(change.rows(wide))
    return part.rows(slice(start - wide.start, stop - wide.start)) if changes else part


class Held:
    """Maps in memory as a `Source`; `skin` is without changes that are still to be worked out."""

    def __init__(self, skin: "SkinMaps") -> None:
        self._skin = skin
        self.shape, self.tile, self.made_by = skin.shape, skin.estimate.tile, skin.made_by
        self.provenance = skin.provenance

    @property
    def known(self) -> Quantiles | None:
        """What its file said."""
        return self._skin.estimate.quantiles

    def knows(self, name: str) -> bool:
        """Whether there is a σ of a map, or "confidence"."""
        if name == "confidence":
            return self._skin.confidence is not None
        return name in self._skin.sigmas

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it."""
        place = self._skin.maps.place
        if place is not None and place.whole != self.shape:
            raise CutisError(
                "these are some rows of a face, and what is to be done looks at all of it: apply "
                "it to the whole, and take the rows then"
            )
        return bands(self.shape)

    def rows(self, rows: slice, trust: bool = True) -> "SkinMaps":
        """Maps of some rows."""
        return self._skin.rows(rows)

    def keep(self) -> None:
        """They are here anyway."""
