"""RGB colour spaces of pipelines, to and from linear sRGB.

A space is its primaries and white, adapted to D65 by Bradford where it has another, and whether its
values are encoded by the sRGB curve. These five work everywhere; they are those of OpenColorIO's
built-in configurations.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.transfer import decode_srgb, encode_srgb
from cutis.errors import CutisError

D65, D60 = (0.3127, 0.3290), (0.32168, 0.33767)
"""Whites of sRGB and of ACES [smpte2065]."""
BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
"""XYZ to the cone responses that whites are adapted in [lam1985bradford]."""
Primaries = tuple[tuple[float, float], ...]
REC709: Primaries = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))


class Space(Protocol):
    """What textures are stored in: values to and from linear sRGB."""

    @property
    def name(self) -> str:
        """What people call it."""

    @property
    def encoded(self) -> bool:
        """Whether values are anything but proportional to light."""

    @property
    def chromaticities(self) -> tuple[float, ...] | None:
        """x, y of red, green, blue and white, where they are known."""

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB, not clamped."""

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → stored values, not clamped."""


def _white(xy: tuple[float, float]) -> NDArray[np.float64]:
    return np.array([xy[0] / xy[1], 1.0, (1 - sum(xy)) / xy[1]])


def _to_xyz(primaries: Primaries, white: tuple[float, float]) -> NDArray[np.float64]:
    """(3, 3) RGB → XYZ, Y of white = 1."""
    columns = np.stack([_white(xy) for xy in primaries], axis=-1)
    return columns * np.linalg.solve(columns, _white(white))


def adaptation(white: ArrayLike, other: ArrayLike) -> NDArray[np.float64]:
    """(3, 3) XYZ under `white` (3,) → XYZ that look the same under `other`, by Bradford."""
    gains = (BRADFORD @ np.asarray(other)) / (BRADFORD @ np.asarray(white))
    return np.linalg.inv(BRADFORD) @ (gains[:, None] * BRADFORD)


def adapted(to_xyz: NDArray[np.float64], white: ArrayLike) -> NDArray[np.float64]:
    """(3, 3) RGB → XYZ under `white` (3,) → RGB → linear sRGB, adapted by Bradford."""
    return np.linalg.inv(_to_xyz(REC709, D65)) @ adaptation(white, _white(D65)) @ to_xyz


def chromaticities_of(matrix: ArrayLike) -> tuple[float, ...]:
    """x, y of red, green, blue and white of values that `matrix` (3, 3) takes to linear sRGB.

    They are of colours under D65, as those of sRGB.
    """
    xyz = _to_xyz(REC709, D65) @ np.asarray(matrix, dtype=np.float64)
    columns = [*xyz.T, xyz.sum(axis=1)]
    return tuple(float(v / column.sum()) for column in columns for v in column[:2])


@dataclass(frozen=True)
class RGBSpace:
    """An RGB space: chromaticities of red, green, blue and white, and whether the sRGB curve.

    Spaces of the same chromaticities and curve are equal, whatever they are called.
    """

    name: str
    primaries: Primaries
    white: tuple[float, float]
    encoded: bool = False

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RGBSpace) and (
            self.chromaticities == other.chromaticities and self.encoded == other.encoded
        )

    def __hash__(self) -> int:
        return hash((self.chromaticities, self.encoded))

    @property
    def chromaticities(self) -> tuple[float, ...]:
        """x, y of red, green, blue and white: eight numbers, as OpenEXR stores them."""
        return tuple(v for xy in (*self.primaries, self.white) for v in xy)

    def to_xyz(self, white: ArrayLike | None = None) -> NDArray[np.float64]:
        """(3, 3) linear values → XYZ, Y of white = 1, adapted to `white` (3,) if given."""
        own, matrix = _white(self.white), _to_xyz(self.primaries, self.white)
        return matrix if white is None else adaptation(own, white) @ matrix

    @cached_property
    def matrix(self) -> NDArray[np.float64]:
        """(3, 3) linear values of this space → linear sRGB; exactly the identity for sRGB's."""
        if (self.primaries, self.white) == (REC709, D65):
            return np.eye(3)
        return adapted(_to_xyz(self.primaries, self.white), _white(self.white))

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB, not clamped; float32 stays float32."""
        stored = np.asarray(values)
        return self.primaries_to_srgb(decode_srgb(stored) if self.encoded else stored)

    def primaries_to_srgb(self, linear: NDArray[np.generic]) -> NDArray[np.floating]:
        """The same of values whose curve is undone already."""
        return _times(linear, self.matrix)

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → values as this space stores them, not clamped."""
        linear = _times(np.asarray(rgb), np.linalg.inv(self.matrix))
        return encode_srgb(linear) if self.encoded else linear

    def with_curve(self, encoded: bool) -> "RGBSpace":
        """The space of the same primaries, encoded by the sRGB curve or linear."""
        if encoded == self.encoded:
            return self
        for known in SPACES:
            if known == replace(self, encoded=encoded):
                return known
        return replace(
            self, encoded=encoded, name=f"{self.name}, {'sRGB' if encoded else 'no'} curve"
        )


def _times(values: NDArray[np.generic], matrix: NDArray[np.floating]) -> NDArray[np.floating]:
    kind = values.dtype if values.dtype in (np.float32, np.float64) else np.dtype(np.float64)
    if np.array_equal(matrix, np.eye(3)):
        return values.astype(kind, copy=False)
    return values.astype(kind, copy=False) @ matrix.T.astype(kind)


P3: Primaries = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
AP0: Primaries = ((0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.0770))
SRGB = RGBSpace("sRGB", REC709, D65, encoded=True)
LINEAR = RGBSpace("linear", REC709, D65)
SPACES = (
    SRGB,
    LINEAR,
    RGBSpace("ACEScg", ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044)), D60),
    RGBSpace("Display P3", P3, D65, encoded=True),
    RGBSpace("Rec.2020", ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046)), D65),
)
"""Display P3 is encoded as sRGB is; Rec.2020 is linear, as renderers hold it."""
ACES2065_1 = RGBSpace("ACES2065-1", AP0, D60)
"""What OpenColorIO configurations of all makers have in common [smpte2065]."""
ALIASES = {
    "lin_rec709": "linear",
    "lin_rec709_scene": "linear",
    "linear rec.709": "linear",
    "linear rec.709 (srgb)": "linear",
    "lin_srgb": "linear",
    "srgb encoded rec.709 (srgb)": "sRGB",
    "srgb_rec709_scene": "sRGB",
    "srgb_tx": "sRGB",
    "lin_ap1": "ACEScg",
    "lin_ap1_scene": "ACEScg",
    "srgb encoded p3-d65": "Display P3",
    "srgb_p3d65_scene": "Display P3",
    "p3": "Display P3",
    "linear rec.2020": "Rec.2020",
    "lin_rec2020": "Rec.2020",
    "lin_rec2020_scene": "Rec.2020",
}


def rgb_space(name: str) -> RGBSpace:
    """The space called `name`, or an alias of it, in either case; CutisError lists them."""
    wanted = ALIASES.get(name.strip().lower(), name.strip()).lower()
    for space in (*SPACES, ACES2065_1):
        if space.name.lower() == wanted:
            return space
    raise CutisError(
        f"unknown colour space {name!r}; known are {', '.join(space.name for space in SPACES)}"
    )
