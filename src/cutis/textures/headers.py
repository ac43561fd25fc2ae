"""What the first bytes of an image say that the decoder does not.

OpenImageIO expands palettes without a word, makes RGB of the CMYK and single bits of a PSD, tries
every plug-in it has on a file it cannot place (among them `null`, which makes up an image for any
name that ends so), unpacks whole JPEGs on opening them, and its PNG decoder prints damage to the
terminal. Looking first avoids all that.
"""

import struct
from pathlib import Path

from cutis.textures.jpeg import check_jpeg
from cutis.textures.png import check_png, png_colour_type
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

_PNG_PALETTE = 3
_PSD_BITS, _PSD_GREY, _PSD_PALETTE, _PSD_RGB, _PSD_CMYK = range(5)
_PSD_HEADER = 26


def image_format(path: Path) -> str:
    """OpenImageIO's name of the format (a second column of SIGNATURES), by content.

    Raises CutisError for a file that is missing, unreadable, empty, truncated or of another format.
    """
    try:
        with open(path, "rb") as file:
            start = file.read(8)
            found = next((name for magic, name in SIGNATURES if start.startswith(magic)), None)
            if found == "png":
                check_png(path, file)
            elif found == "jpeg":
                check_jpeg(path, file)
            elif found == "psd":
                _check_psd(path, start + file.read(_PSD_HEADER - len(start)))
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


def stored_otherwise(path: Path, file_format: str) -> str:
    """What a PNG or PSD stores that OpenImageIO turns into RGB: "palette", "grey", or "" if none.

    For a file that `image_format` accepted.
    """
    if file_format == "png":
        return "palette" if png_colour_type(path) == _PNG_PALETTE else ""
    if file_format == "psd":
        with open(path, "rb") as file:
            mode = _psd_mode(file.read(_PSD_HEADER))
        return {_PSD_BITS: "grey", _PSD_PALETTE: "palette"}.get(mode, "")
    return ""


def _psd_mode(header: bytes) -> int:
    return int(struct.unpack(">H", header[24:26])[0])


def _check_psd(path: Path, header: bytes) -> None:
    if len(header) < _PSD_HEADER:
        raise problem(path, "is truncated: its header is not whole; copy or export it again")
    mode = _psd_mode(header)
    if mode == _PSD_CMYK:
        raise problem(path, "is CMYK, made for print; convert it to RGB")
    if mode not in (_PSD_BITS, _PSD_GREY, _PSD_PALETTE, _PSD_RGB):
        raise problem(path, f"stores another colour model (mode {mode}); convert it to RGB")
