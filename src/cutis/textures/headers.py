"""What the first bytes of an image say that the decoder does not.

OpenImageIO expands palettes and converts the CMYK of PSD without a word, tries every plug-in it has
on a file it cannot place (among them `null`, which makes up an image for any name that ends so),
and its PNG decoder prints damage to the terminal. Looking first avoids all of it.
"""

import os
import struct
import zlib
from pathlib import Path
from typing import BinaryIO

from cutis.textures.problem import problem, reason

SIGNATURES = (
    (b"\x89PNG\r\n\x1a\n", "png"),
    (b"\xff\xd8\xff", "jpeg"),
    (b"II*\0", "tiff"),
    (b"MM\0*", "tiff"),
    (b"II+\0", "tiff"),  # BigTIFF
    (b"MM\0+", "tiff"),
    (b"v/1\x01", "openexr"),
    (b"SDPX", "dpx"),
    (b"XPDS", "dpx"),
    (b"8BPS", "psd"),
)
EXTENSIONS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".tx", ".exr", ".dpx", ".psd")
"""What files of these formats are usually called, lower case."""
PNG_PALETTE = 3
PSD_CMYK = b"\0\4"
LARGEST = 32768  # texels along a side
_PIECE = 1 << 20


def image_format(path: Path) -> str:
    """OpenImageIO's name of the format (a second column of SIGNATURES), by content.

    Raises CutisError for a file that is missing, unreadable, empty, truncated or of another format.
    """
    try:
        with open(path, "rb") as file:
            start = file.read(8)
            found = next((name for magic, name in SIGNATURES if start.startswith(magic)), None)
            if found == "png":
                _check_png(path, file)
            elif found == "psd" and file.read(18)[16:] == PSD_CMYK:
                raise problem(path, "is CMYK, made for print; convert it to RGB")
    except FileNotFoundError as error:
        raise problem(path, "no such file; check the name") from error
    except IsADirectoryError as error:
        raise problem(path, "is a folder; give an image file") from error
    except OSError as error:
        what = (
            "is a folder; give an image file"
            if path.is_dir()
            else f"cannot be read: {reason(error)}"
        )
        raise problem(path, what) from error
    if not start:
        raise problem(path, "is empty (0 bytes); export it again")
    if found is None:
        raise problem(path, "is not a PNG, JPEG, TIFF, OpenEXR, DPX or PSD image; convert it")
    return found


def png_colour_type(path: Path) -> int:
    """Colour type in the header of a PNG that `image_format` accepted: 3 is a palette."""
    with open(path, "rb") as file:
        return file.read(26)[25]


def _check_png(path: Path, file: BinaryIO) -> None:
    """Walk the chunks of a PNG: all there, checksums right, a sensible size in the header."""
    end, ordinal, kind = os.fstat(file.fileno()).st_size, 0, b""
    while kind != b"IEND":
        header = file.read(8)
        if len(header) < 8:
            raise problem(
                path, "is truncated: the end of the PNG is missing; copy or export it again"
            )
        length, kind = struct.unpack(">I4s", header)
        if file.tell() + length + 4 > end:
            raise problem(
                path, "is truncated: the end of the PNG is missing; copy or export it again"
            )
        checksum, first = zlib.crc32(kind), b""
        for offset in range(0, length, _PIECE):
            piece = file.read(min(_PIECE, length - offset))
            first = first or piece
            checksum = zlib.crc32(piece, checksum)
        if struct.unpack(">I", file.read(4))[0] != checksum:
            raise problem(path, "is damaged: a PNG checksum is wrong; copy or export it again")
        if ordinal == 0:
            if kind != b"IHDR" or length != 13:
                raise problem(path, "is damaged: the PNG header is missing; export it again")
            check_size(path, *struct.unpack(">II", first[:8]))
        ordinal += 1


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse an image without texels or with a side longer than `LARGEST` texels."""
    if width < 1 or height < 1:
        raise problem(path, f"has no texels ({width} × {height}); export it again")
    if max(width, height) > LARGEST:
        what = f"claims {width} × {height} texels, the limit is {LARGEST} × {LARGEST}"
        raise problem(path, f"{what}; split it into tiles, or export it again if it is damaged")
