"""RGB colour spaces of pipelines, to and from linear sRGB.

A space is its primaries and white, adapted to D65 by Bradford where it has another, and whether its
values are encoded by the sRGB curve. These five work everywhere; they are those of OpenColorIO's
built-in configurations.
"""

from dataclasses import dataclass

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
REC709 = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))


def _white(xy: tuple[float, float]) -> NDArray[np.float64]:
    return np.array([xy[0] / xy[1], 1.0, (1 - sum(xy)) / xy[1]])


def _to_xyz(
    primaries: tuple[tuple[float, float], ...], white: tuple[float, float]
) -> NDArray[np.float64]:
    """(3, 3) RGB → XYZ under D65, Y of white = 1."""
    columns = np.stack([_white(xy) for xy in primaries], axis=-1)
    matrix = columns * np.linalg.solve(columns, _white(white))
    gains = (BRADFORD @ _white(D65)) / (BRADFORD @ _white(white))
    return np.linalg.inv(BRADFORD) @ (gains[:, None] * BRADFORD) @ matrix


@dataclass(frozen=True)
class RGBSpace:
    """An RGB space: chromaticities of red, green, blue and white, and its encoding."""

    name: str
    primaries: tuple[tuple[float, float], ...]
    white: tuple[float, float]
    encoded: bool = False

    @property
    def chromaticities(self) -> tuple[float, ...]:
        """x, y of red, green, blue and white: eight numbers, as OpenEXR stores them."""
        return tuple(v for xy in (*self.primaries, self.white) for v in xy)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """(3, 3) linear values of this space → linear sRGB."""
        return np.linalg.inv(_to_xyz(REC709, D65)) @ _to_xyz(self.primaries, self.white)

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB, not clamped."""
        stored = np.asarray(values)
        return (decode_srgb(stored) if self.encoded else stored) @ self.matrix.T

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → values as this space stores them, not clamped."""
        linear = np.asarray(rgb) @ np.linalg.inv(self.matrix).T
        return encode_srgb(linear) if self.encoded else linear


P3 = ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
SPACES = (
    RGBSpace("sRGB", REC709, D65, encoded=True),
    RGBSpace("linear", REC709, D65),
    RGBSpace("ACEScg", ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044)), D60),
    RGBSpace("Display P3", P3, D65, encoded=True),
    RGBSpace("Rec.2020", ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046)), D65),
)
"""Display P3 is encoded as sRGB is; Rec.2020 is linear, as renderers hold it."""
ALIASES = {
    "lin_rec709": "linear",
    "linear rec.709 (srgb)": "linear",
    "lin_srgb": "linear",
    "srgb encoded rec.709 (srgb)": "sRGB",
    "srgb_tx": "sRGB",
    "lin_ap1": "ACEScg",
    "srgb encoded p3-d65": "Display P3",
    "p3": "Display P3",
    "linear rec.2020": "Rec.2020",
    "lin_rec2020": "Rec.2020",
}


def rgb_space(name: str) -> RGBSpace:
    """The space called `name`, or an alias of it, in either case; CutisError lists them."""
    wanted = ALIASES.get(name.strip().lower(), name.strip()).lower()
    for space in SPACES:
        if space.name.lower() == wanted:
            return space
    raise CutisError(
        f"unknown colour space {name!r}; known are {', '.join(space.name for space in SPACES)}"
    )
