"""RGB spaces of a matrix and three tone curves, as ICC profiles, PNG and TIFF describe them."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import ACES2065_1, SPACES, Primaries, RGBSpace, Space

STEEPEST = 16.0
"""Exponents beyond are no tone curve, and floating-point numbers would not hold their values."""
ALIKE = 2e-3
"""Spaces whose linear colours differ by less, from black to white, are the same: files round."""
Values = NDArray[np.float64]


class Curve(Protocol):
    """Stored values of one channel and light, 0 to 1 and beyond."""

    def to_linear(self, stored: Values) -> Values:
        """Stored values → light."""

    def from_linear(self, light: Values) -> Values:
        """The inverse."""


@dataclass(frozen=True)
class PowerCurve:
    """(a x + b)^g + e for x ≥ d, else c x + f; powers are odd about 0 [icc].

    Raises ValueError where that is no tone curve.
    """

    g: float
    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = -1.0
    e: float = 0.0
    f: float = 0.0

    def __post_init__(self) -> None:
        if not (1 / STEEPEST <= self.g <= STEEPEST and self.a > 0):
            raise ValueError("damaged")

    @property
    def pure(self) -> bool:
        """Whether it is xᵍ."""
        return (self.a, self.b, self.c, self.d, self.e, self.f) == (1, 0, 0, -1, 0, 0)

    def to_linear(self, stored: Values) -> Values:
        """Stored values → light."""
        curved = _odd(self.a * stored + self.b, self.g) + self.e
        return curved if self.pure else np.where(stored >= self.d, curved, self.c * stored + self.f)

    def from_linear(self, light: Values) -> Values:
        """The inverse."""
        curved = (_odd(light - self.e, 1 / self.g) - self.b) / self.a
        if self.pure:
            return curved
        straight = (light - self.f) / self.c if self.c else np.full_like(light, self.d)
        knee = _odd(np.array(self.a * self.d + self.b), self.g) + self.e
        return np.where(light >= knee, curved, straight)


@dataclass(frozen=True, eq=False)
class TableCurve:
    """Light at evenly spaced stored values from 0 to 1, straight between them.

    Odd about 0 where it begins there; values above 1 take its end. Raises ValueError where it does
    not rise.
    """

    light: Values

    def __post_init__(self) -> None:
        if (np.diff(self.light) < 0).any() or self.light[-1] <= self.light[0]:
            raise ValueError("damaged")

    def to_linear(self, stored: Values) -> Values:
        """Stored values → light."""
        return self._looked_up(stored, self._places(), self.light)

    def from_linear(self, light: Values) -> Values:
        """The inverse."""
        return self._looked_up(light, self.light, self._places())

    def _places(self) -> Values:
        return np.linspace(0, 1, len(self.light))

    def _looked_up(self, x: Values, places: Values, values: Values) -> Values:
        if self.light[0] > 0:
            return np.interp(x, places, values)
        return np.copysign(np.interp(np.abs(x), places, values), x)


@dataclass(frozen=True, eq=False)
class CurveSpace:
    """An RGB space: curves of red, green and blue, then `matrix` (3, 3) to linear sRGB."""

    name: str
    matrix: Values
    curves: tuple[Curve, Curve, Curve]
    encoded: bool = True
    chromaticities: None = None

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB."""
        stored = np.asarray(values)
        light = [c.to_linear(stored[..., i].astype(float)) for i, c in enumerate(self.curves)]
        return (np.stack(light, -1) @ self.matrix.T).astype(_kind(stored))

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → stored values."""
        colours = np.asarray(rgb)
        light = colours @ np.linalg.inv(self.matrix).T
        stored = [c.from_linear(light[..., i]) for i, c in enumerate(self.curves)]
        return np.stack(stored, -1).astype(_kind(colours))


def curve_space(
    name: str, primaries: Primaries, white: tuple[float, float], *curves: Curve
) -> Space:
    """The space of these chromaticities and of one curve or three; one of ours if it is alike.

    Raises ValueError for chromaticities that are no RGB space.
    """
    matrix = usable(RGBSpace(name, primaries, white)).matrix
    red, green, blue = curves if len(curves) == 3 else curves * 3
    return one_of_ours(CurveSpace(name, matrix, (red, green, blue)))


def usable(space: RGBSpace) -> RGBSpace:
    """The space itself; ValueError where its chromaticities are no RGB space."""
    try:
        good = bool(np.isfinite(space.matrix).all()) and abs(np.linalg.det(space.matrix)) > 1e-6
        good = good and float(np.abs(space.matrix).max()) < 1e6
    except (ArithmeticError, ValueError):
        good = False
    if not good:
        raise ValueError("chromaticities that are no RGB space")
    return space


def one_of_ours(found: Space) -> Space:
    """One of our own spaces if it gives the same colours, else `found` itself."""
    for space in (*SPACES, ACES2065_1):
        if alike(space, found):
            return space
    return found


def alike(one: Space, other: Space) -> bool:
    """Whether two spaces give the same colours, from black to white, to within ALIKE."""
    steps = np.linspace(0, 1, 18)
    values = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    apart = np.abs(one.to_linear_srgb(values) - other.to_linear_srgb(values)).max()
    return bool(apart < ALIKE)


def _kind(values: NDArray[np.generic]) -> type[np.floating]:
    return np.float32 if values.dtype == np.float32 else np.float64


def _odd(x: Values, power: float) -> Values:
    return np.sign(x) * np.abs(x) ** power
