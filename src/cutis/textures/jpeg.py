"""JPEGs looked at before a decoder sees them.

Of a progressive JPEG the decoder unpacks all scans, into memory for the whole image, as soon as it
is opened. So its size and the number of its scans are looked up first.
"""

import struct
from pathlib import Path
from typing import BinaryIO

from cutis.textures.limits import check_claim, check_size
from cutis.textures.problem import problem

_FRAMES = {0xC0 + i for i in range(16)} - {0xC4, 0xC8, 0xCC}  # the others are tables
_ALONE = {0x01, *range(0xD0, 0xD9)}  # markers without data
_SCAN, _END = 0xDA, 0xD9
_MOST_SCANS = 100  # programs make 1 to 20
_PIECE = 1 << 20


def check_jpeg(path: Path, file: BinaryIO) -> None:
    """Refuse a frame header that the file cannot hold, and more scans than anyone makes.

    Raises CutisError. What is damaged otherwise is left to the decoder.
    """
    file.seek(2)
    while (marker := _marker(file)) not in (None, _SCAN, _END):
        if marker in _ALONE:
            continue
        (length,) = struct.unpack(">H", file.read(2).rjust(2, b"\0"))
        if marker in _FRAMES:
            _check_frame(path, file.read(6))
            length -= 6
        file.seek(max(0, length - 2), 1)
    scans, before = int(marker == _SCAN), b""
    while piece := file.read(_PIECE):
        scans += (before + piece).count(b"\xff\xda")
        before = piece[-1:] if piece.endswith(b"\xff") else b""
    if scans > _MOST_SCANS:
        raise problem(
            path, f"is packed in {scans} scans, more than any program makes; export it again"
        )


def _marker(file: BinaryIO) -> int | None:
    """The next marker; None at the end of the file or where there is none."""
    first = file.read(1)
    while first and first != b"\xff":  # the decoder skips these too
        first = file.read(1)
    while first == b"\xff":
        first = file.read(1)
    return first[0] if first else None


def _check_frame(path: Path, frame: bytes) -> None:
    if len(frame) == 6:
        _, height, width, count = struct.unpack(">BHHB", frame)
        if height and width:  # else the decoder has its own words
            check_size(path, width, height)
            check_claim(path, width, height, width * height * count)
