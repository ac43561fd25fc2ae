"""Plain maps: named arrays over a texture, and where on it they hold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.maps.statistics import coordinates
from cutis.optics import NAMES, RARE_NAMES

Map = NDArray[np.float32]


@dataclass(frozen=True)
class Place:
    """Where some rows stand in a texture: the number of the first, and (H, W) of the whole."""

    first_row: int
    whole: tuple[int, int]


def read_only(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Map:
    """A float32 view that cannot be written to; CutisError where it has not `shape`."""
    view = np.asarray(values, dtype=np.float32).view()
    view.flags.writeable = False
    if view.shape != shape:
        raise CutisError(f"{name} is {view.shape}, the maps are {shape[:2]}")
    return view


@dataclass(frozen=True, eq=False)
class Maps:
    """Maps (H, W) of what a skin is made of by name, float32, in the units of `optics`.

    The five of `optics.NAMES` are always there, rare chromophores where somebody set them. `mask`
    (H, W) in [0, 1] says where they hold; they are 0 where it is 0. Of some rows of a larger
    texture, `place` says which. Arrays are read-only.
    """

    values: Mapping[str, Map]
    mask: Map
    place: Place | None = None

    def __post_init__(self) -> None:
        missing = [name for name in NAMES if name not in self.values]
        unknown = [name for name in self.values if name not in (*NAMES, *RARE_NAMES)]
        if missing or unknown:
            what = f"no {missing[0]}" if missing else f"an unknown map {unknown[0]}"
            raise CutisError(f"skin maps are {', '.join(NAMES)} and rarer ones; there is {what}")
        shape = np.shape(self.mask)
        if len(shape) != 2:
            raise CutisError(f"the mask is {shape}, the maps are two-dimensional")
        checked = {name: read_only(name, found, shape) for name, found in self.values.items()}
        object.__setattr__(self, "values", checked)
        object.__setattr__(self, "mask", read_only("mask", self.mask, shape))

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.mask.shape[0], self.mask.shape[1]

    @property
    def rare(self) -> tuple[str, ...]:
        """Names of the rare chromophores that have a map."""
        return tuple(name for name in RARE_NAMES if name in self.values)

    @property
    def names(self) -> tuple[str, ...]:
        """What the colours of these maps depend on, in the order of `parameters`."""
        return (*NAMES, *RARE_NAMES) if self.rare else NAMES

    @property
    def whole(self) -> Place:
        """Where these maps stand; of a whole texture, at its first row."""
        return self.place or Place(0, self.shape)

    def __getitem__(self, name: str) -> Map:
        """(H, W) the map called `name`, of 0 for a rare chromophore that has none."""
        if name in self.values:
            return self.values[name]
        if name in RARE_NAMES:
            return np.zeros(self.shape, dtype=np.float32)
        raise KeyError(name)

    def parameters(self, names: Sequence[str] | None = None) -> Map:
        """(H, W, 5) parameters in the order of `optics.NAMES`, or others by name; 0 for no map."""
        return np.stack([self[name] for name in (names or NAMES)], axis=-1)

    def rows(self, rows: slice) -> "Maps":
        """Some rows."""
        first = rows.indices(self.shape[0])[0]
        at = Place(self.whole.first_row + first, self.whole.whole)
        parts = {name: found[rows] for name, found in self.values.items()}
        return Maps(parts, self.mask[rows], at)

    def with_values(self, changed: Mapping[str, Map]) -> "Maps":
        """The same with some maps in place of others."""
        return Maps({**self.values, **changed}, self.mask, self.place)

    def coordinates(self) -> Map:
        """(H, W, 5) network coordinates where the mask is not 0, else 0."""
        return coordinates([self[name] for name in NAMES], self.mask > 0)
