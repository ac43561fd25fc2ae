"""ICC profiles of our own RGB spaces, for files that would otherwise not say theirs [icc].

Version 4: a matrix to XYZ under D50 and one parametric curve.
"""

import struct

import numpy as np
from numpy.typing import ArrayLike

from cutis.colour.spaces import RGBSpace, adaptation
from cutis.textures.icc import D50

SRGB_CURVE = (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
"""g, a, b, c, d of a parametric curve of type 3."""
_HEADER_SIZE = 128


def icc_profile(space: RGBSpace) -> bytes:
    """A display profile of `space`; the same bytes whenever it is made."""
    white = space.to_xyz().sum(axis=1)
    columns = space.to_xyz(D50).T
    curve = _curve(space.encoded)
    tags = {
        b"desc": _text(space.name),
        b"cprt": _text("CC0"),
        b"wtpt": _xyz(D50),
        b"chad": b"sf32" + bytes(4) + _fixed(adaptation(white, D50)),
        **{name + b"XYZ": _xyz(xyz) for name, xyz in zip((b"r", b"g", b"b"), columns, strict=True)},
        **{name + b"TRC": curve for name in (b"r", b"g", b"b")},
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


def _curve(encoded: bool) -> bytes:
    numbers = SRGB_CURVE if encoded else (1.0,)
    return b"para" + struct.pack(">4xH2x", 3 if encoded else 0) + _fixed(numbers)
