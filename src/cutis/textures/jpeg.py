"""JPEGs looked at before a decoder sees them [jpeg].

Of a progressive JPEG the decoder unpacks all scans, into memory for the whole image, as soon as it
is opened. So its size and the number of its scans are looked up first. What the segments in front
of the scans say of colour, orientation and further pictures is kept.
"""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from cutis.textures.limits import check_claim, check_size
from cutis.textures.problem import problem

_FRAMES = {0xC0 + i for i in range(16)} - {0xC4, 0xC8, 0xCC}  # the others are tables
_ALONE = {0x01, *range(0xD0, 0xD9)}  # markers without data
_SCAN, _END = 0xDA, 0xD9
_EXIF, _PROFILES = 0xE1, 0xE2
_LOSSLESS = {0xC3, 0xC7, 0xCB, 0xCF}
_MOST_SCANS = 100  # programs make 1 to 20
_PIECE = 1 << 20
_XMP = b"http://ns.adobe.com/xap/1.0/\0"


@dataclass
class JpegSegments:
    """What a JPEG says beside its pixels.

    `exif` and `xmp` are the blocks of these names, `profile` says whether there is an ICC profile,
    `more` whether it is one of several pictures in the file (MPF), `kind` of what JPEG it is that
    the decoder may not know, "" for the usual ones.
    """

    exif: bytes = b""
    xmp: bytes = b""
    profile: bool = False
    more: bool = False
    kind: str = ""


def check_jpeg(path: Path, file: BinaryIO) -> JpegSegments:
    """Refuse a frame header that the file cannot hold, and more scans than anyone makes.

    Raises CutisError. What is damaged otherwise is left to the decoder.
    """
    file.seek(2)
    found = JpegSegments()
    while (marker := _marker(file)) not in (None, _SCAN, _END):
        if marker in _ALONE:
            continue
        (length,) = struct.unpack(">H", file.read(2).rjust(2, b"\0"))
        after = file.tell() + max(0, length - 2)
        if marker in _FRAMES:
            frame = file.read(6)
            _check_frame(path, frame)
            found.kind = _kind(marker, frame)
        elif marker in (_EXIF, _PROFILES):
            _keep(found, marker, file.read(max(0, length - 2)))
        file.seek(after)
    scans, before = int(marker == _SCAN), b""
    while piece := file.read(_PIECE):
        scans += (before + piece).count(b"\xff\xda")
        before = piece[-1:] if piece.endswith(b"\xff") else b""
    if scans > _MOST_SCANS:
        raise problem(
            path, f"is packed in {scans} scans, more than any program makes; export it again"
        )
    return found


def _keep(found: JpegSegments, marker: int, data: bytes) -> None:
    if marker == _PROFILES:
        found.profile |= data.startswith(b"ICC_PROFILE\0")
        found.more |= data.startswith(b"MPF\0")
    elif data.startswith(b"Exif\0\0"):
        found.exif = found.exif or data
    elif data.startswith(_XMP):
        found.xmp = found.xmp or data[len(_XMP) :]


def _marker(file: BinaryIO) -> int | None:
    """The next marker; None at the end of the file or where there is none."""
    first = file.read(1)
    while first and first != b"\xff":  # the decoder skips these too
        first = file.read(1)
    while first == b"\xff":
        first = file.read(1)
    return first[0] if first else None


def _kind(marker: int | None, frame: bytes) -> str:
    """What the frame header says of JPEG's rarer kinds."""
    if marker in _LOSSLESS:
        return "lossless JPEG"
    return f"JPEG of {frame[0]} bits" if frame and frame[0] != 8 else ""


def _check_frame(path: Path, frame: bytes) -> None:
    if len(frame) == 6:
        _, height, width, count = struct.unpack(">BHHB", frame)
        if height and width:  # else the decoder has its own words
            check_size(path, width, height)
            check_claim(path, width, height, width * height * count)
