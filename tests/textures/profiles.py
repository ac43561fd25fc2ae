"""ICC profiles written by hand, tag by tag."""

import struct

import numpy as np

D50 = (0.9642, 1.0, 0.8249)
SRGB = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.71410]]
"""XYZ of red, green and blue under D50; what sRGB's own profile holds."""
ADOBE = [[0.60974, 0.31111, 0.01947], [0.20528, 0.62567, 0.06087], [0.14919, 0.06322, 0.74457]]
PROPHOTO = [[0.79767, 0.28804, 0.0], [0.13519, 0.71188, 0.0], [0.03134, 0.00008, 0.82491]]
P3 = [[0.51512, 0.24120, -0.00105], [0.29198, 0.69225, 0.04189], [0.15710, 0.06657, 0.78407]]


def fixed(*numbers):
    return struct.pack(f">{len(numbers)}i", *(round(number * 65536) for number in numbers))


def gamma(power):
    return b"curv" + struct.pack(">4xIH", 1, round(power * 256))


def table(values):
    codes = np.rint(np.asarray(values) * 65535).astype(">u2")
    return b"curv" + struct.pack(">4xI", len(codes)) + codes.tobytes()


def para(kind, *numbers):
    return b"para" + struct.pack(">4xH2x", kind) + fixed(*numbers)


def profile(columns=SRGB, curve=None, name="by hand", space=b"RGB ", pcs=b"XYZ ", **tags):
    """A profile of version 2, or with a description as in version 4 (`desc` bytes given)."""
    text = name.encode("ascii") + b"\0"
    entries = {"desc": b"desc" + struct.pack(">4xI", len(text)) + text + bytes(78)}
    entries |= {"cprt": b"text\0\0\0\0CC0\0", "wtpt": b"XYZ \0\0\0\0" + fixed(*D50)}
    for letter, xyz in zip("rgb", columns, strict=True):
        entries[f"{letter}XYZ"] = b"XYZ \0\0\0\0" + fixed(*xyz)
        entries[f"{letter}TRC"] = gamma(2.2) if curve is None else curve
    entries = {key: value for key, value in (entries | tags).items() if value is not None}
    body, index = b"", struct.pack(">I", len(entries))
    start = 132 + 12 * len(entries)
    for key, value in entries.items():
        index += struct.pack(">4sII", key.encode(), start + len(body), len(value))
        body += value.ljust(-(-len(value) // 4) * 4, b"\0")
    header = struct.pack(">I4xI4s4s4s6H4s", start + len(body), 0x02400000, b"mntr", space, pcs,
                         2026, 1, 1, 0, 0, 0, b"acsp")  # fmt: skip
    return header.ljust(68, b"\0") + fixed(*D50) + bytes(48) + index + body
