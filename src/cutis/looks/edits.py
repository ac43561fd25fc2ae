"""What a layer of a look does to one map, everywhere or where its mask is.

Contrast, blurs, and what is done to detail or to large areas alone, are worked out in network
coordinates u, in which even steps look even. With L the large areas of a map x and E an edit,

    x → E(x)  everywhere,    u(x) + u(E(L)) − u(L)  large areas,    and the rest of it  detail,

so that the two parts together do what the whole does.
"""

import abc
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from cutis.errors import CutisError
from cutis.looks.blur import Blur
from cutis.looks.document import MapName, Radius, Share, texels
from cutis.looks.effect import EditPart, Effect
from cutis.looks.tone import Tone
from cutis.maps import Edit, Face, Tile
from cutis.maps.plain import Map
from cutis.optics import NAMES, Parameter, parameter

Number = Annotated[float, Field(ge=-1e6, le=1e6)]
Factor = Annotated[float, Field(ge=0, le=1e6)]
Areas = Literal["all", "detail", "large"]


class MapEdit(EditPart):
    """One edit of one map."""

    key: ClassVar[str] = "to"
    """The field that says how much."""

    map: MapName
    areas: Areas = Field(
        default="all", description="All of the map, its detail or its large areas only."
    )
    radius: Radius | None = Field(
        default=None,
        description="What is larger is a large area; needed for detail and large areas.",
    )

    @model_validator(mode="after")
    def _radius_fits(self) -> "MapEdit":
        if self.areas != "all" and self.radius is None:
            raise ValueError("detail and large areas need a radius, such as 0.01")
        if self.areas == "all" and self.radius is not None:
            raise ValueError('a radius says what is detail; say areas "detail" or "large" too')
        return self

    @property
    def touches(self) -> frozenset[str]:
        """Its map."""
        return frozenset({self.map})

    @property
    def reads(self) -> frozenset[str]:
        """Its map, where it needs the large areas of it."""
        return frozenset() if self.radius is None else frozenset({self.map})

    @property
    def placed(self) -> bool:
        """Where it needs the large areas."""
        return self.radius is not None

    @abc.abstractmethod
    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit, and how much of that."""

    def __str__(self) -> str:
        edit, share = self.plain()
        return f"{edit}{'' if share == 1 else f', {share:g} of the way'}{self.where}"

    @property
    def where(self) -> str:
        """Words for its areas."""
        return {"all": "", "detail": " in detail", "large": " in large areas"}[self.areas]

    def on_face(self, face: Face) -> Effect:
        """The edit ready for a face."""
        edit, share = self.plain()
        if self.areas == "all":
            return Plain(edit, share)
        known, low = parameter(self.map), _large(self.map, self.radius, face)

        def shift(u: Map, values: Map, large: Map) -> Map:
            before = np.asarray(known.from_coordinate(large), dtype=np.float32)
            moved = _coordinate(known, edit.of(before)) - _coordinate(known, before)
            if self.areas == "detail":
                moved = _coordinate(known, edit.of(values)) - _coordinate(known, values) - moved
            return np.float32(share) * moved

        return Moved(known, shift, low)


class Multiply(MapEdit):
    """A factor."""

    key: ClassVar[str] = "by"

    do: Literal["multiply"] = "multiply"
    by: Factor

    @property
    def absolute(self) -> bool:
        """A factor is none."""
        return False

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "multiply", self.by), 1.0


class Offset(MapEdit):
    """An amount in the map's unit, added."""

    key: ClassVar[str] = "by"

    do: Literal["offset"] = "offset"
    by: Number

    @property
    def absolute(self) -> bool:
        """It is one."""
        return True

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "offset", self.by), 1.0


class _ToValue(MapEdit):
    to: Number

    @model_validator(mode="after")
    def _in_range(self) -> "_ToValue":
        parameter(self.map).check(self.to)
        return self

    @property
    def absolute(self) -> bool:
        """A value is one, except at the ends of a range."""
        known = parameter(self.map)
        return self.to not in (known.low, known.high)


class Set(_ToValue):
    """A value in the map's unit."""

    do: Literal["set"] = "set"

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "set", self.to), 1.0


class Blend(_ToValue):
    """Some of the way to a value."""

    do: Literal["blend"] = "blend"
    share: Share

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "set", self.to), self.share


class Floor(_ToValue):
    """A least value."""

    do: Literal["floor"] = "floor"

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "floor", self.to), 1.0


class Ceiling(_ToValue):
    """A largest value."""

    do: Literal["ceiling"] = "ceiling"

    def plain(self) -> tuple[Edit, float]:
        """The same as a plain edit."""
        return Edit(self.map, "ceiling", self.to), 1.0


class Contrast(EditPart):
    """Differences to the face's median, or to what is around, times a factor.

    Below 1 evens and smooths, above 1 enhances.
    """

    do: Literal["contrast"] = "contrast"
    map: MapName
    by: Annotated[float, Field(ge=0, le=100)]
    about: Literal["median", "local"] = Field(
        default="median", description="The median of the whole face, or a blur of `radius` around."
    )
    radius: Radius | None = None

    @model_validator(mode="after")
    def _radius_fits(self) -> "Contrast":
        if (self.about == "local") != (self.radius is not None):
            raise ValueError("contrast about what is local needs a radius, about the median none")
        if self.about == "median" and self.map not in NAMES:
            raise ValueError(f"there is no median of {self.map}, which only edits set")
        return self

    @property
    def touches(self) -> frozenset[str]:
        """Its map."""
        return frozenset({self.map})

    @property
    def reads(self) -> frozenset[str]:
        """Its map."""
        return frozenset({self.map})

    @property
    def placed(self) -> bool:
        """Where it looks around."""
        return self.about == "local"

    @property
    def absolute(self) -> bool:
        """It has no numbers of amounts."""
        return False

    def __str__(self) -> str:
        around = "the median" if self.about == "median" else "what is around"
        return f"{self.map} contrast x{self.by:g} about {around}"

    def on_face(self, face: Face) -> Effect:
        """The edit ready for a face."""
        known, gain = parameter(self.map), np.float32(self.by - 1)
        if self.about == "local":
            low = _large(self.map, self.radius, face)
            return Moved(known, lambda u, values, large: gain * (u - large), low)
        middle = np.float32(known.to_coordinate(face.percentile(self.map, 0.5)))
        return Moved(known, lambda u, values, large: gain * (u - middle), None, self.by)


class Soften(EditPart):
    """A blur."""

    do: Literal["blur"] = "blur"
    map: MapName
    radius: Radius

    @property
    def touches(self) -> frozenset[str]:
        """Its map."""
        return frozenset({self.map})

    @property
    def reads(self) -> frozenset[str]:
        """Its map."""
        return frozenset({self.map})

    @property
    def placed(self) -> bool:
        """Where it looks around."""
        return True

    @property
    def absolute(self) -> bool:
        """It has no numbers of amounts."""
        return False

    def __str__(self) -> str:
        told = self.radius if isinstance(self.radius, str) else f"{self.radius:g}"
        return f"{self.map} blurred by {told}"

    def on_face(self, face: Face) -> Effect:
        """The edit ready for a face."""
        low = _large(self.map, self.radius, face)
        return Moved(parameter(self.map), lambda u, values, large: large - u, low)


# ready for a face --------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Plain:
    """An edit of each texel by itself, `share` of it."""

    edit: Edit
    share: float = 1.0
    reach: int = 0
    trust: bool = False

    def __call__(self, tile: Tile, weight: Map) -> Tile:
        """The tile edited; σ as `maps.Edit` has it."""
        name, maps = self.edit.parameter, tile.maps
        weight = weight if self.share == 1 else np.float32(self.share) * weight
        edited, clamped = self.edit(maps[name], weight)
        sigmas = dict(tile.sigmas)
        if name in sigmas:
            sigmas[name] = self.edit.sigma(sigmas[name], weight)
        maps = maps.with_values({name: edited})
        return Tile(maps, sigmas, (*tile.clamped, clamped), tile.confidence)


class Moved:
    """A map moved in its coordinate.

    `shift` takes coordinates, values and blurred coordinates (h, W) and says by how much. σ is
    multiplied by `spread`, and else stays: what is around a texel is no better known than it.
    """

    trust = False

    def __init__(
        self, known: Parameter, shift: Callable[[Map, Map, Map], Map], low: Blur | None,
        spread: float = 1.0,
    ) -> None:  # fmt: skip
        self._known, self._shift, self._low, self._spread = known, shift, low, spread
        self.reach = 0 if low is None else low.reach

    def __call__(self, tile: Tile, weight: Map) -> Tile:
        """The tile edited."""
        from cutis.looks.coordinate_kernel import move

        known, maps = self._known, tile.maps
        values, inside = maps[known.name], maps.mask > 0
        u = coordinates(known, values, inside)
        large = u if self._low is None else self._low(u, inside.astype(np.float32), maps.whole)
        by = np.ascontiguousarray(self._shift(u, values, large), dtype=np.float32)
        out, clamped = np.empty_like(values), np.zeros(len(values), dtype=np.int64)
        ends = np.float32(known.low), np.float32(known.high)
        move(len(values), values, by, weight, known.root, *_line(known), *ends, out, clamped)
        sigmas = dict(tile.sigmas)
        if known.name in sigmas and self._spread != 1:
            wide = sigmas[known.name] * (1 + weight * np.float32(self._spread - 1))
            sigmas[known.name] = np.minimum(wide, np.float32(known.high - known.low))
        maps = maps.with_values({known.name: out})
        return Tile(maps, sigmas, (*tile.clamped, int(clamped.sum())), tile.confidence)


def coordinates(known: Parameter, values: Map, inside: Any) -> Map:
    """Network coordinates (h, W) of a map where `inside`, else 0."""
    from cutis.looks.coordinate_kernel import to_coordinates

    out = np.empty(values.shape, np.float32)
    to_coordinates(len(values), values, inside, known.root, *_line(known), out)
    return out


def _coordinate(known: Parameter, values: Map) -> Map:
    return coordinates(known, values, np.ones(values.shape, dtype=bool))


def _line(known: Parameter) -> tuple[float, float]:
    """Where the root of a parameter starts, and how far it goes."""
    low, high = known.low ** (1 / known.root), known.high ** (1 / known.root)
    return low, high - low


def _large(name: str, radius: float | str | None, face: Face) -> Blur:
    """The large areas of a map."""
    assert radius is not None
    known = parameter(name)

    def field(tile: Tile) -> tuple[Map, Map]:
        inside = tile.maps.mask > 0
        return coordinates(known, tile.maps[name], inside), inside.astype(np.float32)

    return Blur(texels(radius, face.shape), field, face)


AnyEdit = Annotated[
    Multiply | Offset | Set | Blend | Floor | Ceiling | Contrast | Soften | Tone,
    Field(discriminator="do"),
]
"""Every kind of edit that a layer may have. Another kind is one more class here."""


def edit_of(edit: Edit) -> Any:
    """A plain edit as a part of a document; CutisError where its amount is an array."""
    if isinstance(edit.amount, np.ndarray):
        raise CutisError(f"{edit}: an amount for each texel is in no document; use a mask")
    kind = _PLAIN[edit.operation]
    return kind.model_validate({"map": edit.parameter, kind.key: float(edit.amount)})


_PLAIN: dict[str, type[MapEdit]] = {
    "multiply": Multiply, "offset": Offset, "set": Set, "floor": Floor, "ceiling": Ceiling,
}  # fmt: skip
