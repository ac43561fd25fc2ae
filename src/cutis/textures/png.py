"""PNG files looked through before a decoder sees them [png].

The PNG decoder prints what is wrong with a file on the terminal, and OpenImageIO gives no way to
stop it. So whatever it would refuse is found here first: chunks, checksums, the header, and, in
files of usual length, the compressed rows, which are inflated a piece at a time. What the chunks
say of colour, orientation and further pictures is kept.
"""

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from cutis.errors import CutisError
from cutis.textures.limits import check_size
from cutis.textures.problem import problem

_PALETTE = 3
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
_BITS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
# First column and row, steps, of the passes of an interlaced image.
_ADAM7 = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
          (0, 1, 1, 2))  # fmt: skip
_WHOLE = ((0, 0, 1, 1),)
_FILTERS = 5
_SIGNATURE = 8  # bytes
_PIECE = 1 << 20
_INFLATED = 16 << 20  # bytes of a file: with right checksums only a hostile one has wrong rows
_KEPT = {b"cICP", b"iCCP", b"sRGB", b"gAMA", b"cHRM", b"eXIf", b"acTL"}
_TEXTS = {b"tEXt", b"zTXt", b"iTXt"}
_LONGEST_KEPT, _MOST_TEXTS = 1 << 16, 1000


@dataclass(frozen=True)
class PngChunks:
    """What a PNG says beside its pixels: its chunks by name, and texts by keyword, as bytes."""

    palette: bool = False
    chunks: dict[bytes, bytes] = field(default_factory=dict)
    texts: dict[bytes, bytes] = field(default_factory=dict)


def check_png(path: Path, file: BinaryIO, inflate: bool = True) -> PngChunks:
    """Refuse what the decoder would complain of.

    Without `inflate`, and in files above 16 MiB, the rows are judged by checksums alone. Raises
    CutisError where chunks are missing, cut off, damaged or out of order, where the header makes no
    sense or is too large, or where the rows are not all there.
    """
    rows, seen = None, set()
    kept: dict[bytes, bytes] = {}
    texts: dict[bytes, bytes] = {}
    file.seek(_SIGNATURE)
    inflated = inflate and os.fstat(file.fileno()).st_size <= _INFLATED
    for kind, pieces in _chunks(path, file):
        if kind == b"CgBI":
            what = "is a PNG as Xcode packs them, which other programs cannot read; export it again"
            raise problem(path, what)
        if rows is None:
            header = b"" if kind != b"IHDR" else b"".join(pieces)
            if len(header) != 13:
                raise _damaged(path, "its header is missing")
            rows = _Rows(path, header)
        elif kind == b"IHDR" or (kind == b"PLTE" and kind in seen):
            raise _damaged(path, "a part comes twice")
        elif kind == b"IDAT":
            if rows.colour == _PALETTE and b"PLTE" not in seen:
                raise _damaged(path, "its palette is missing")
            for piece in pieces if inflated else ():
                rows.take(piece)
        elif kind == b"PLTE":
            size = sum(len(piece) for piece in pieces)
            if rows.colour == _PALETTE and (size % 3 or not 0 < size <= 768):
                raise _damaged(path, "its palette is damaged")
        elif kind == b"IEND":
            if inflated:
                rows.finish()
        elif kind in _KEPT and kind not in kept:
            kept[kind] = _start(pieces)
        elif kind in _TEXTS and len(texts) < _MOST_TEXTS:
            keyword, text = _text(kind, _start(pieces))
            texts.setdefault(keyword, text)
        elif not (kind.isalpha() and kind[:1].islower()):
            raise _damaged(path, "it has a part that no program knows")
        for _ in pieces:
            pass
        seen.add(kind)
    return PngChunks(rows is not None and rows.colour == _PALETTE, kept, texts)


def _start(pieces: Iterator[bytes]) -> bytes:
    """What a chunk holds, cut at 64 KiB."""
    start = b""
    for piece in pieces:
        start += piece[: _LONGEST_KEPT - len(start)]
    return start


def _text(kind: bytes, data: bytes) -> tuple[bytes, bytes]:
    """Keyword, in lower case, and text of a chunk of text, unpacked as far as it is kept."""
    keyword, _, text = data.partition(b"\0")
    packed = kind == b"zTXt"
    if kind == b"iTXt":
        packed = text[:1] == b"\1"
        text = text[2:].split(b"\0", 2)[-1]  # behind language and translated keyword
    elif packed:
        text = text[1:]
    if packed:
        try:
            text = zlib.decompressobj().decompress(text, _LONGEST_KEPT)
        except zlib.error:
            text = b""
    return keyword.lower(), text


def _chunks(path: Path, file: BinaryIO) -> Iterator[tuple[bytes, Iterator[bytes]]]:
    """Name and data of each chunk, to be read in turn, up to the last."""
    end, kind = os.fstat(file.fileno()).st_size, b""
    while kind != b"IEND":
        header = file.read(8)
        length, kind = struct.unpack(">I4s", header.ljust(8, b"\0"))
        if len(header) < 8 or file.tell() + length + 4 > end:
            raise problem(
                path, "is truncated: the end of the PNG is missing; copy or export it again"
            )
        yield kind, _checked(path, file, kind, length)


def _checked(path: Path, file: BinaryIO, kind: bytes, length: int) -> Iterator[bytes]:
    checksum = zlib.crc32(kind)
    for offset in range(0, length, _PIECE):
        piece = file.read(min(_PIECE, length - offset))
        checksum = zlib.crc32(piece, checksum)
        yield piece
    if struct.unpack(">I", file.read(4))[0] != checksum:
        raise problem(path, "is damaged: a PNG checksum is wrong; copy or export it again")


class _Rows:
    """Inflates rows and looks at the filter byte in front of each."""

    def __init__(self, path: Path, header: bytes) -> None:
        width, height, bits, self.colour, *methods = struct.unpack(">IIBBBBB", header)
        check_size(path, width, height)
        known = bits in _BITS.get(self.colour, ()) and methods[:2] == [0, 0] and methods[2] < 2
        if not known:
            raise _damaged(path, "its header makes no sense")
        self._path = path
        self._inflate = zlib.decompressobj()
        self._more = False  # than the image needs, which decoders ignore
        # Bytes of a row, filter byte included, and where the data of each pass ends.
        self._passes: list[tuple[int, int]] = []
        end = 0
        for column, row, across, down in _ADAM7 if methods[2] else _WHOLE:
            columns, rows = -((column - width) // across), -((row - height) // down)
            if columns > 0 and rows > 0:
                stride = 1 + -(-columns * _CHANNELS[self.colour] * bits // 8)
                end += rows * stride
                self._passes.append((stride, end))
        self._start = self._at = 0  # of the current pass, and of what comes next

    def take(self, packed: bytes) -> None:
        """Some more compressed data; none to look at what still waits to be unpacked."""
        part = b"more"
        while (packed or part) and not (self._inflate.eof or self._more):
            try:
                part = self._inflate.decompress(packed, _PIECE if self._passes else 1)
            except zlib.error as error:
                raise _damaged(self._path, "its pixels cannot be unpacked") from error
            packed = self._inflate.unconsumed_tail
            self._more = not self._passes and len(part) > 0
            self._look(part)

    def _look(self, part: bytes) -> None:
        while part and self._passes:
            stride, end = self._passes[0]
            here, part = part[: end - self._at], part[end - self._at :]
            first = (self._start - self._at) % stride
            if max(here[first::stride], default=0) >= _FILTERS:
                raise _damaged(self._path, "a row is packed in an unknown way")
            self._at += len(here)
            if self._at == end:
                self._start = end
                self._passes.pop(0)

    def finish(self) -> None:
        """To be called when no more data come."""
        self.take(b"")
        if self._passes or not (self._inflate.eof or self._more):
            raise _damaged(self._path, "rows are missing")


def _damaged(path: Path, what: str) -> CutisError:
    return problem(path, f"is damaged: {what}; copy or export it again")
