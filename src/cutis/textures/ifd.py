"""Directories of tags, as TIFF files and Exif blocks hold them [tiff6] [exif].

Only the tags that say how texels lie, which picture is which and in what colours; a decoder reads
the rest. Whatever is damaged is left out: the decoder has its own words for that.
"""

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO

SUBFILE, OLD_SUBFILE, WIDTH, HEIGHT, COMPRESSION = 254, 255, 256, 257, 259
PHOTOMETRIC, ORIENTATION, TRANSFER_FUNCTION, WHITE_POINT, PRIMARIES = 262, 274, 301, 318, 319
SUB_DIRECTORIES, XMP, EXIF, PROFILE = 330, 700, 34665, 34675
EXIF_COLOUR_SPACE, EXIF_INTEROP, EXIF_GAMMA = 0xA001, 0xA005, 0xA500
INTEROP_INDEX = 1
_WANTED = {
    *(SUBFILE, OLD_SUBFILE, WIDTH, HEIGHT, COMPRESSION, PHOTOMETRIC, ORIENTATION),
    *(TRANSFER_FUNCTION, WHITE_POINT, PRIMARIES, SUB_DIRECTORIES, XMP, EXIF, PROFILE),
    *(EXIF_COLOUR_SPACE, EXIF_INTEROP, EXIF_GAMMA, INTEROP_INDEX),
}
# Letter of struct, None for pairs that are fractions, by the number of the type.
_TYPES = {
    1: "B", 2: "s", 3: "H", 4: "I", 5: "II", 6: "b", 7: "s", 8: "h", 9: "i", 10: "ii", 11: "f",
    12: "d", 13: "I", 16: "Q", 17: "q", 18: "Q",
}  # fmt: skip
_MOST_PAGES, _MOST_ENTRIES, _MOST_BYTES = 256, 4096, 1 << 20

Value = tuple[float, ...] | bytes


@dataclass(frozen=True)
class Directory:
    """Tags and values of a directory; `exif` and `interop` are those that it points to."""

    tags: dict[int, Value] = field(default_factory=dict)
    exif: dict[int, Value] = field(default_factory=dict)
    interop: dict[int, Value] = field(default_factory=dict)

    def number(self, tag: int, otherwise: int = 0) -> int:
        """The first value of a tag, as a whole number."""
        return whole(self.tags, tag, otherwise)

    def text(self, tag: int) -> bytes:
        """The value of a tag as it is stored, where it is text or bytes; else nothing."""
        value = self.tags.get(tag, b"")
        if isinstance(value, bytes):
            return value
        fits = all(v in range(256) for v in value)  # XMP may be an array of numbers
        return bytes(int(v) for v in value) if fits else b""


def whole(tags: dict[int, Value], tag: int, otherwise: int = 0) -> int:
    """The first value of a tag of a directory, as a whole number."""
    value = tags.get(tag)
    if isinstance(value, tuple) and value and abs(value[0]) < 2**53:  # NaN fails too
        return int(value[0])
    return otherwise


def directories(file: BinaryIO, most: int = _MOST_PAGES) -> list[Directory]:
    """The chain of directories of a TIFF, at most `most`, from a file that is open for reading."""
    return list(_chain(file, most))


def exif_block(block: bytes) -> Directory:
    """The first directory of an Exif block, which is a small TIFF; empty where it is damaged."""
    block = block.removeprefix(b"Exif\0\0")
    found = directories(io.BytesIO(block), 1) if block[:2] in (b"II", b"MM") else []
    return found[0] if found else Directory()


def _chain(file: BinaryIO, most: int) -> Iterator[Directory]:
    head = _read(file, 0, 16)
    order = {b"II": "<", b"MM": ">"}.get(head[:2])
    if order is None or len(head) < 8:
        return
    (magic,) = struct.unpack(f"{order}H", head[2:4])
    big = magic == 43
    if big and len(head) < 16:
        return
    (at,) = struct.unpack(f"{order}{'Q' if big else 'I'}", head[8:16] if big else head[4:8])
    seen: set[int] = set()
    while at and at not in seen and len(seen) < most:
        seen.add(at)
        tags, following = _tags(file, at, order, big)
        exif: dict[int, Value] = {}
        interop: dict[int, Value] = {}
        if place := whole(tags, EXIF):
            exif, _ = _tags(file, place, order, big)
        if place := whole(exif, EXIF_INTEROP):
            interop, _ = _tags(file, place, order, big)
        yield Directory(tags, exif, interop)
        at = following


def _tags(file: BinaryIO, at: int, order: str, big: bool) -> tuple[dict[int, Value], int]:
    """Wanted tags of the directory at `at`, and where the next one is, 0 for none."""
    lead, size, room, word = (8, 20, 8, "Q") if big else (2, 12, 4, "I")
    start = _read(file, at, lead)
    if len(start) < lead:
        return {}, 0
    (count,) = struct.unpack(f"{order}{'Q' if big else 'H'}", start)
    if count > _MOST_ENTRIES:
        return {}, 0
    entries = _read(file, at + lead, size * count)
    after = _read(file, at + lead + size * count, room)
    following = struct.unpack(f"{order}{word}", after)[0] if len(after) == room else 0
    found: dict[int, Value] = {}
    for entry in range(len(entries) // size):
        part = entries[entry * size : (entry + 1) * size]
        tag, kind, length = struct.unpack(f"{order}HH{word}", part[: 4 + room])
        if tag in _WANTED and tag not in found and kind in _TYPES:
            value = _value(file, part[4 + room :], kind, length, order, word)
            if value is not None:
                found[tag] = value
    return found, following


def _value(
    file: BinaryIO, field: bytes, kind: int, length: int, order: str, word: str
) -> Value | None:
    code = _TYPES[kind]
    size = length * struct.calcsize(f"{order}{code}")
    if not 0 < size <= _MOST_BYTES:
        return None
    if size > len(field):
        field = _read(file, struct.unpack(f"{order}{word}", field)[0], size)
    if len(field) < size:
        return None
    if code == "s":
        return field[:size]
    values = struct.unpack(f"{order}{length * len(code)}{code[0]}", field[:size])
    if len(code) == 1:
        return values
    pairs = zip(values[::2], values[1::2], strict=True)
    return tuple(top / below if below else float("nan") for top, below in pairs)


def _read(file: BinaryIO, at: int, count: int) -> bytes:
    """`count` bytes from `at` on; fewer where the file has none."""
    try:
        file.seek(at)
        return file.read(count)
    except (OSError, OverflowError, ValueError):
        return b""
