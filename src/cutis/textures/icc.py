"""ICC profiles made of a matrix and three curves, in floating point [icc].

That is what displays, cameras and painting programs embed for RGB. Colour engines with Python
bindings work in 8 bits, which would cost more than the model's own error.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import ACES2065_1, SPACES, Space, adapted

D50 = (0.9642, 1.0, 0.8249)
"""XYZ of the white that profiles are written for."""
STEEPEST = 16.0
"""Exponents beyond are no tone curve, and floating-point numbers would not hold their values."""
Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class IccSpace:
    """An RGB space as a profile describes it: curves, then `matrix` (3, 3) to linear sRGB.

    Curves given as tables are odd about 0, and values above 1 take their end.
    """

    name: str
    matrix: NDArray[np.float64]
    curves: tuple[tuple[Curve, Curve], ...]
    encoded: bool = True
    chromaticities: None = None

    def to_linear_srgb(self, values: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) stored values → linear sRGB."""
        stored = np.asarray(values)
        linear = np.stack(
            [c[0](stored[..., i].astype(float)) for i, c in enumerate(self.curves)], -1
        )
        return (linear @ self.matrix.T).astype(_kind(stored))

    def from_linear_srgb(self, rgb: ArrayLike) -> NDArray[np.floating]:
        """(..., 3) linear sRGB → stored values."""
        colours = np.asarray(rgb)
        linear = colours @ np.linalg.inv(self.matrix).T
        stored = np.stack([c[1](linear[..., i]) for i, c in enumerate(self.curves)], -1)
        return stored.astype(_kind(colours))


def _kind(values: NDArray[np.generic]) -> type[np.floating]:
    return np.float32 if values.dtype == np.float32 else np.float64


def icc_space(profile: bytes) -> Space:
    """The space that a profile describes; one of `colour.SPACES` where it is the same.

    Raises ValueError, with what the profile is instead, for profiles that are not RGB, are tables
    (printers), or are damaged.
    """
    try:
        with np.errstate(all="ignore"):  # of damaged ones; what comes of it is looked at
            return _parse(profile)
    except (struct.error, IndexError, UnicodeDecodeError) as error:
        raise ValueError("damaged") from error


def _parse(profile: bytes) -> Space:
    kind, connection = profile[16:20], profile[20:24]
    if kind != b"RGB ":
        raise ValueError(f"for {kind.decode('ascii').strip() or 'unknown'} colour")
    (count,) = struct.unpack(">I", profile[128:132])
    tags = {}
    for entry in range(min(count, 200)):
        name, offset, size = struct.unpack(">4sII", profile[132 + 12 * entry : 144 + 12 * entry])
        tags[name] = profile[offset : offset + size]
    wanted = [c + t for t in (b"XYZ", b"TRC") for c in (b"r", b"g", b"b")]
    if connection != b"XYZ " or any(not tags.get(name) for name in wanted):
        raise ValueError("a table instead of a matrix and curves")
    columns = [_fixed(tags[c + b"XYZ"][8:], 3) for c in (b"r", b"g", b"b")]
    matrix = adapted(np.stack(columns, axis=-1), D50)
    matrix /= matrix.sum(axis=1, keepdims=True)  # rounding must not tint greys
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) < 1e-6:
        raise ValueError("damaged")
    curves = tuple(_curve(tags[c + b"TRC"]) for c in (b"r", b"g", b"b"))
    found = IccSpace(_description(tags.get(b"desc", b"")), matrix, curves)
    return _known(found)


def _known(found: IccSpace) -> Space:
    """One of our own spaces if the profile gives its colours to two thousandths."""
    steps = np.linspace(0, 1, 18)
    values = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    theirs = found.to_linear_srgb(values)
    for space in (*SPACES, ACES2065_1):
        if np.abs(space.to_linear_srgb(values) - theirs).max() < 2e-3:
            return space
    return found


def _fixed(data: bytes, count: int) -> NDArray[np.float64]:
    """The first `count` numbers of 15 + 16 bits."""
    return np.array(struct.unpack(f">{count}i", data[: 4 * count])) / 65536


def _description(tag: bytes) -> str:
    text = ""
    if tag[:4] == b"desc" and len(tag) >= 12:
        (size,) = struct.unpack(">I", tag[8:12])
        text = tag[12 : 12 + size].decode("ascii", "replace")
    elif tag[:4] == b"mluc" and len(tag) >= 28:
        size, offset = struct.unpack(">II", tag[20:28])
        text = tag[offset : offset + size].decode("utf-16-be", "replace")
    shown = "".join(c for c in text if c.isprintable()).strip()[:60]
    return shown or "its ICC profile"


def _curve(tag: bytes) -> tuple[Curve, Curve]:
    """A tone curve, stored → linear, and its inverse."""
    if tag[:4] == b"para":
        return _parametric(tag)
    if tag[:4] != b"curv":
        raise ValueError("made of curves of an unknown kind")
    (count,) = struct.unpack(">I", tag[8:12])
    if count < 2:
        gamma = 1.0 if count == 0 else struct.unpack(">H", tag[12:14])[0] / 256
        return _power(gamma, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0)
    if len(tag) < 12 + 2 * count:
        raise ValueError("damaged")
    table = np.frombuffer(tag, ">u2", count, 12).astype(np.float64) / 65535
    if (np.diff(table) < 0).any() or table[-1] <= table[0]:
        raise ValueError("damaged")
    places = np.linspace(0, 1, count)
    if table[0] > 0:
        return lambda x: np.interp(x, places, table), lambda y: np.interp(y, table, places)
    return lambda x: _mirrored(x, places, table), lambda y: _mirrored(y, table, places)


def _mirrored(
    x: NDArray[np.float64], places: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.copysign(np.interp(np.abs(x), places, values), x)


def _parametric(tag: bytes) -> tuple[Curve, Curve]:
    """Types 0 to 4: y = (a x + b)^g + e for x ≥ d, else c x + f."""
    (kind,) = struct.unpack(">H", tag[8:10])
    if kind > 4:
        raise ValueError("made of curves of an unknown kind")
    values = _fixed(tag[12:], (1, 3, 4, 5, 7)[kind])
    g, a, b, c, d, e, f = [float(v) for v in values] + [0.0] * (7 - len(values))
    if kind == 0:
        return _power(g, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0)
    if kind in (1, 2):  # the third number is an offset, and the curve is flat below -b/a
        offset = c if kind == 2 else 0.0
        return _power(g, a, b, 0.0, -b / a if a else -1.0, offset, offset)
    return _power(g, a, b, c, d, e, f)


def _power(
    g: float, a: float, b: float, c: float, d: float, e: float, f: float
) -> tuple[Curve, Curve]:
    if not (0 < g <= STEEPEST and a > 0):
        raise ValueError("damaged")

    def forth(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(x >= d, _odd(a * x + b, g) + e, c * x + f)

    def back(y: NDArray[np.float64]) -> NDArray[np.float64]:
        straight = (y - f) / c if c else np.full_like(y, d)
        return np.where(
            y >= _odd(np.array(a * d + b), g) + e, (_odd(y - e, 1 / g) - b) / a, straight
        )

    return forth, back


def _odd(x: NDArray[np.float64], power: float) -> NDArray[np.float64]:
    return np.sign(x) * np.abs(x) ** power
