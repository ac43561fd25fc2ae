"""ICC profiles of RGB spaces, for files that would otherwise not say theirs [icc].

Version 4: a matrix to XYZ under D50 and three curves. They are made and not kept as files, since
spaces come with any primaries and curves that a header may state.
"""

import struct

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import LINEAR, RGBSpace, adaptation
from cutis.textures.curves import Curve, CurveSpace, PowerCurve, TableCurve
from cutis.textures.icc import D50

SRGB_CURVE = (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
"""g, a, b, c, d of a parametric curve of type 3."""
_HEADER_SIZE = 128
_LONGEST_TABLE = 4096  # entries; readers hold no more either


def icc_profile(space: RGBSpace | CurveSpace) -> bytes:
    """A display profile of `space`; the same bytes whenever it is made."""
    if isinstance(space, CurveSpace):
        rec709 = LINEAR.to_xyz()
        white, columns = rec709.sum(axis=1), (LINEAR.to_xyz(D50) @ space.matrix).T
        curves = [_curve(curve) for curve in space.curves]
    else:
        white, columns = space.to_xyz().sum(axis=1), space.to_xyz(D50).T
        curves = [_curve(PowerCurve(*SRGB_CURVE) if space.encoded else PowerCurve(1.0))] * 3
    rgb = (b"r", b"g", b"b")
    tags = {
        b"desc": _text(space.name),
        b"cprt": _text("CC0"),
        b"wtpt": _xyz(D50),
        b"chad": b"sf32" + bytes(4) + _fixed(adaptation(white, D50)),
        **{name + b"XYZ": _xyz(xyz) for name, xyz in zip(rgb, columns, strict=True)},
        **{name + b"TRC": curve for name, curve in zip(rgb, curves, strict=True)},
    }
    table, blob, places = struct.pack(">I", len(tags)), b"", {}
    start = _HEADER_SIZE + 4 + 12 * len(tags)
    for name, data in tags.items():
        if data not in places:
            places[data] = start + len(blob)
            blob += data.ljust(-(-len(data) // 4) * 4, b"\0")
        table += name + struct.pack(">II", places[data], len(data))
    return _header(start + len(blob)) + table + blob


def _header(size: int) -> bytes:
    header = bytearray(_HEADER_SIZE)
    struct.pack_into(">I4xI4s4s4s6H4s", header, 0, size, 0x04300000, b"mntr", b"RGB ", b"XYZ ",
                     2000, 1, 1, 0, 0, 0, b"acsp")  # fmt: skip
    header[68:80] = _fixed(D50)
    return bytes(header)


def _fixed(numbers: ArrayLike) -> bytes:
    return np.rint(np.asarray(numbers) * 65536).astype(">i4").tobytes()


def _xyz(numbers: ArrayLike) -> bytes:
    return b"XYZ " + bytes(4) + _fixed(numbers)


def _text(text: str) -> bytes:
    encoded = text.encode("utf-16-be")
    return b"mluc" + struct.pack(">4xII2s2sII", 1, 12, b"en", b"US", len(encoded), 28) + encoded


def _curve(curve: Curve) -> bytes:
    """A curve of either kind as a tag."""
    if isinstance(curve, PowerCurve):
        numbers: tuple[float, ...]
        if curve.pure:
            kind, numbers = 0, (curve.g,)
        elif curve.e == curve.f == 0:
            kind, numbers = 3, (curve.g, curve.a, curve.b, curve.c, curve.d)
        else:
            kind, numbers = 4, (curve.g, curve.a, curve.b, curve.c, curve.d, curve.e, curve.f)
        return b"para" + struct.pack(">4xH2x", kind) + _fixed(numbers)
    assert isinstance(curve, TableCurve)
    light: NDArray[np.float64] = curve.light
    if len(light) > _LONGEST_TABLE:
        light = curve.to_linear(np.linspace(0, 1, _LONGEST_TABLE))
    codes = np.rint(np.clip(light, 0, 1) * 65535).astype(">u2")
    return b"curv" + struct.pack(">4xI", len(codes)) + codes.tobytes()
