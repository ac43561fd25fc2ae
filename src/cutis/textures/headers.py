"""What the first bytes of an image say that the decoder does not.

OpenImageIO expands palettes without a word, makes RGB of the CMYK and single bits of a PSD, tries
every plug-in it has on a file it cannot place (among them `null`, which makes up an image for any
name that ends so), unpacks whole JPEGs on opening them, knows little of the colour that headers
state, and its PNG decoder prints damage to the terminal. Looking first avoids all that; a file that
did not change since is not looked at again.
"""

import contextlib
import struct
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO

from cutis.textures.ifd import Directory, directories, exif_block
from cutis.textures.jpeg import check_jpeg
from cutis.textures.png import check_png
from cutis.textures.problem import problem
from cutis.textures.regular import open_regular, state

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
# Bytes, where they stand, and what such a file is: not read, but not rubbish either.
_OTHERS = (
    (b"WEBP", 8, "a WebP image"),
    (b"ftypavi", 4, "an AVIF image"),
    (b"ftyphei", 4, "a HEIF image"),
    (b"ftypmif1", 4, "a HEIF image"),
    (b"ftypcrx ", 4, "a raw photograph"),
    (b"\xff\x0a", 0, "a JPEG XL image"),
    (b"\0\0\0\x0cJXL ", 0, "a JPEG XL image"),
    (b"\0\0\0\x0cjP  ", 0, "a JPEG 2000 image"),
    (b"\xff\x4f\xff\x51", 0, "a JPEG 2000 image"),
    (b"GIF8", 0, "a GIF image"),
    (b"#?RADIANCE", 0, "a Radiance picture"),
    (b"#?RGBE", 0, "a Radiance picture"),
    (b"DDS ", 0, "a DDS texture"),
    (b"\xabKTX", 0, "a KTX texture"),
    (b"\x80\x2a\x5f\xd7", 0, "a Cineon scan"),
    (b"\xd7\x5f\x2a\x80", 0, "a Cineon scan"),
    (b"gimp xcf", 0, "a GIMP project"),
    (b"%PDF", 0, "a PDF document"),
    (b"\x93NUMPY", 0, "a NumPy array"),
    (b"PK\x03\x04", 0, "a ZIP archive"),
)
_PSD_BITS, _PSD_GREY, _PSD_PALETTE, _PSD_RGB, _PSD_CMYK = range(5)
_PSD_HEADER = 26
_PSD_PROFILE, _PSD_EXIF, _PSD_XMP = 1039, 1058, 1060
_LONGEST_RESOURCE = 1 << 20


@dataclass(frozen=True)
class Header:
    """What a file says of itself, in its own words.

    `stored` is "palette" or "grey" where a decoder would make RGB of it. `pages` are the
    directories of a TIFF, or the one of an Exif block; `chunks` and `texts` those of a PNG that
    matter here. `profile` says whether there is an ICC profile, whole or not, `more` in words which
    further pictures there are, `kind` which rare kind of its format it is.
    """

    format: str
    stored: str = ""
    pages: tuple[Directory, ...] = ()
    chunks: dict[bytes, bytes] = field(default_factory=dict)
    texts: dict[bytes, bytes] = field(default_factory=dict)
    xmp: bytes = b""
    profile: bool = False
    more: str = ""
    kind: str = ""


def image_header(path: Path) -> Header:
    """The header of an image, by content.

    Raises CutisError for a file that is missing, unreadable, no regular file, empty, truncated or
    of another format. `format` is OpenImageIO's name, a second column of SIGNATURES.
    """
    try:
        known = state(path)
    except (OSError, ValueError):
        known = None  # what is wrong is said on opening it
    return _looked(path, known)


@lru_cache(maxsize=64)
def _looked(path: Path, _: tuple[str, int, int, int, int] | None) -> Header:
    try:
        with open_regular(path) as file:
            start = file.read(32)
            found = next((name for magic, name in SIGNATURES if start.startswith(magic)), None)
            if found == "png":
                return _png(path, file)
            if found == "jpeg":
                return _jpeg(path, file)
            if found == "tiff":
                return _tiff(file)
            if found == "psd":
                return _psd(path, file)
    except OSError as error:
        raise problem(path, f"cannot be read: {error.strerror or error}; copy it again") from error
    if not start:
        raise problem(path, "is empty (0 bytes); export it again")
    if found is None:
        other = next((what for magic, at, what in _OTHERS if start[at:].startswith(magic)), None)
        if other is not None:
            what = f"is {other}, not a PNG, JPEG, TIFF, OpenEXR, DPX or PSD image"
            raise problem(path, f"{what}; convert it to one of these")
        raise problem(path, "is not a PNG, JPEG, TIFF, OpenEXR, DPX or PSD image; convert it")
    return Header(found)


def _png(path: Path, file: BinaryIO) -> Header:
    found = check_png(path, file)
    exif = (exif_block(found.chunks[b"eXIf"]),) if b"eXIf" in found.chunks else ()
    return Header(
        "png",
        "palette" if found.palette else "",
        exif,
        found.chunks,
        found.texts,
        found.texts.get(b"xml:com.adobe.xmp", b""),
        b"iCCP" in found.chunks,
        "is an animation" if b"acTL" in found.chunks else "",
    )


def _jpeg(path: Path, file: BinaryIO) -> Header:
    found = check_jpeg(path, file)
    return Header(
        "jpeg",
        pages=(exif_block(found.exif),) if found.exif else (),
        xmp=found.xmp,
        profile=found.profile,
        more="holds further pictures (MPF)" if found.more else "",
        kind=found.kind,
    )


def _tiff(file: BinaryIO) -> Header:
    return Header("tiff", pages=tuple(directories(file)))


def _psd(path: Path, file: BinaryIO) -> Header:
    file.seek(0)
    header = file.read(_PSD_HEADER)
    if len(header) < _PSD_HEADER:
        raise problem(path, "is truncated: its header is not whole; copy or export it again")
    (mode,) = struct.unpack(">H", header[24:26])
    if mode == _PSD_CMYK:
        raise problem(path, "is CMYK, made for print; convert it to RGB")
    if mode not in (_PSD_BITS, _PSD_GREY, _PSD_PALETTE, _PSD_RGB):
        raise problem(path, f"stores another colour model (mode {mode}); convert it to RGB")
    found = _psd_resources(file)
    return Header(
        "psd",
        {_PSD_BITS: "grey", _PSD_PALETTE: "palette"}.get(mode, ""),
        pages=(exif_block(found[_PSD_EXIF]),) if _PSD_EXIF in found else (),
        xmp=found.get(_PSD_XMP, b""),
        profile=_PSD_PROFILE in found,
    )


def _psd_resources(file: BinaryIO) -> dict[int, bytes]:
    """The first image resources of the kinds that matter here, from behind the header on [psd]."""
    found: dict[int, bytes] = {}
    with contextlib.suppress(struct.error):
        (colours,) = struct.unpack(">I", file.read(4))
        file.seek(colours, 1)
        (length,) = struct.unpack(">I", file.read(4))
        end = file.tell() + length
        while file.tell() < end and file.read(4) == b"8BIM":
            number, name = struct.unpack(">HB", file.read(3))
            file.seek(name | 1, 1)  # padded with its length to an even number
            (size,) = struct.unpack(">I", file.read(4))
            after = file.tell() + size + size % 2
            if number in (_PSD_EXIF, _PSD_XMP, _PSD_PROFILE) and number not in found:
                found[number] = file.read(min(size, _LONGEST_RESOURCE))
            file.seek(after)
    return found
