"""ICC profiles made of a matrix and three curves, in floating point [icc].

That is what displays, cameras and painting programs embed for RGB. Colour engines with Python
bindings work in 8 bits, which would cost more than the model's own error, or clip at 0 and 1.
"""

import struct

import numpy as np
from numpy.typing import NDArray

from cutis.colour.spaces import Space, adapted
from cutis.textures.curves import Curve, CurveSpace, PowerCurve, TableCurve, one_of_ours

D50 = (0.9642, 1.0, 0.8249)
"""XYZ of the white that profiles are written for."""


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
    red, green, blue = (_curve(tags[c + b"TRC"]) for c in (b"r", b"g", b"b"))
    return one_of_ours(CurveSpace(_description(tags.get(b"desc", b"")), matrix, (red, green, blue)))


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


def _curve(tag: bytes) -> Curve:
    if tag[:4] == b"para":
        return _parametric(tag)
    if tag[:4] != b"curv":
        raise ValueError("made of curves of an unknown kind")
    (count,) = struct.unpack(">I", tag[8:12])
    if count < 2:
        return PowerCurve(1.0 if count == 0 else struct.unpack(">H", tag[12:14])[0] / 256)
    if len(tag) < 12 + 2 * count:
        raise ValueError("damaged")
    return TableCurve(np.frombuffer(tag, ">u2", count, 12).astype(np.float64) / 65535)


def _parametric(tag: bytes) -> Curve:
    """Types 0 to 4: y = (a x + b)^g + e for x ≥ d, else c x + f."""
    (kind,) = struct.unpack(">H", tag[8:10])
    if kind > 4:
        raise ValueError("made of curves of an unknown kind")
    values = _fixed(tag[12:], (1, 3, 4, 5, 7)[kind])
    g, a, b, c, d, e, f = [float(v) for v in values] + [0.0] * (7 - len(values))
    if kind == 0:
        return PowerCurve(g)
    if kind in (1, 2):  # the third number is an offset, and the curve is flat below -b/a
        offset = c if kind == 2 else 0.0
        return PowerCurve(g, a, b, 0.0, -b / a if a else -1.0, offset, offset)
    return PowerCurve(g, a, b, c, d, e, f)
