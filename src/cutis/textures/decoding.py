"""The one way in through OpenImageIO: stored values of any supported file, rows at a time."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.textures.closing import Closing
from cutis.textures.headers import image_format
from cutis.textures.limits import check_claim, check_size, check_tile
from cutis.textures.problem import check_name, problem, shorten

STORED_AS = {
    "uint8": "uint8",
    "uint16": "uint16",
    "half": "half",
    "float": "float",
    "double": "float",  # the nearest supported
}
_RGB_PHOTOMETRICS = (2, 6)  # RGB, and YCbCr, which decodes to RGB
_GREY_PHOTOMETRICS = (0, 1)
_PALETTE = 3
# Whose limits are known; others (DWA, Zstandard) have next to none.
_PACKING = {
    *("none", "packbits", "lzw", "zip", "jpeg"),  # TIFF
    *("rle", "zips", "piz", "pxr24", "b44", "b44a"),  # OpenEXR, which has none and zip too
}


class Decoder(Closing):
    """First image of an open file; `rows` gives stored values (h, W, C) of rows from top to bottom.

    Values are uint8, uint16, float16 or float32. `step` is the number of rows that are stored
    together: bands of rows that start at multiples of it are cheapest. Memory is that of the rows
    asked for, except for formats whose decoders hold a whole image (interlaced PNG, PSD). Close it,
    or use it in a with block.

    Raises CutisError, in one line, for a file that is missing or not whole, too large, deep, CMYK,
    or of a sample type that cannot be kept; what is not whole may show only at the rows concerned.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.file_format = image_format(path)
        check_name(path)
        hints = oiio.ImageSpec()
        hints.attribute("oiio:UnassociatedAlpha", 1)  # leave alpha alone, however it is stored
        source = oiio.ImageInput.open(str(path), hints)
        if source is None:
            raise _unreadable(path, pending_error())
        self._source = source
        try:
            self.spec: oiio.ImageSpec = source.spec().copy()
            "".join(self.spec.channelnames).encode()  # what is not UTF-8 comes as lone surrogates
            self.stored_as = _check(path, self.spec)
            _check_claim(path, self.file_format, self.spec, self.stored_as)
            together = int(self.spec.get_int_attribute("oiio:RowsPerChunk", 1))
            self.step = self.spec.tile_height or min(max(1, together), self.spec.height)
        except UnicodeError as cause:
            self.close()
            raise problem(path, "is damaged: a name in it is not text; export it again") from cause
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Lets go of the file; a second call does nothing."""
        self._source.close()
        pending_error(self._source)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.spec.height, self.spec.width

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """The type that rows come in."""
        names = {"half": "float16", "float": "float32"}
        return np.dtype(names.get(self.stored_as, self.stored_as))

    def rows(self, rows: slice) -> NDArray[np.generic]:
        """Stored values (h, W, C) of some rows."""
        spec, source = self.spec, self._source
        top, bottom, _ = rows.indices(spec.height)
        left, right = spec.x, spec.x + spec.width
        count = spec.nchannels
        try:
            if spec.tile_width:
                first = top - top % spec.tile_height
                last = min(spec.height, -(-bottom // spec.tile_height) * spec.tile_height)
                pixels = source.read_tiles(
                    left, right, spec.y + first, spec.y + last, spec.z, spec.z + 1, 0, count,
                    self.stored_as,
                )  # fmt: skip
                if pixels is not None:
                    shaped = np.asarray(pixels).reshape(last - first, spec.width, count)
                    pixels = shaped[top - first : bottom - first]
            else:
                pixels = source.read_scanlines(
                    spec.y + top, spec.y + bottom, 0, 0, count, self.stored_as
                )
            # JPEG gives a full array, grey where the data ended, and says so only here.
            error = pending_error(source)
        except UnicodeError as cause:
            raise problem(self.path, "is damaged; copy or export it again") from cause
        if pixels is None or error:
            raise _unreadable(self.path, error)
        return np.asarray(pixels).reshape(bottom - top, spec.width, count)


@dataclass(frozen=True, eq=False)
class Decoded:
    """`pixels` (H, W, C) as they are stored: uint8, uint16, float16 or float32."""

    pixels: NDArray[np.generic]
    spec: oiio.ImageSpec
    format: str


def decode(path: Path) -> Decoded:
    """All of the first image of a file; see `Decoder`."""
    with Decoder(path) as source:
        check_memory(path, source.spec, source.stored_as)
        return Decoded(source.rows(slice(None)), source.spec, source.file_format)


def pending_error(source: oiio.ImageInput | oiio.ImageOutput | None = None) -> str:
    """What OpenImageIO has to say of `source` and in general; unread, it prints that at exit."""
    texts = []
    for speaker in (source, oiio):
        try:
            texts.append(speaker.geterror() if speaker is not None else "")
        except UnicodeDecodeError:  # it quotes bytes of a damaged file
            texts.append("damaged text")
    return texts[0] or texts[1]


def photometric(spec: oiio.ImageSpec) -> int | None:
    """TIFF's photometric interpretation (2 is RGB, 3 a palette, 5 CMYK); None for other formats."""
    value = int(spec.get_int_attribute("tiff:PhotometricInterpretation", -1))
    return None if value < 0 else value


def is_palette(spec: oiio.ImageSpec) -> bool:
    """Whether a TIFF stores indices into a palette, which OpenImageIO has expanded to RGB."""
    return photometric(spec) == _PALETTE


def check_finite(path: Path, values: NDArray[np.generic], first_row: int = 0) -> None:
    """Refuse NaN and infinity in `values` (h, W, C), naming how many texels and where the first."""
    if values.dtype.kind != "f":
        return
    bad = ~np.isfinite(values).all(axis=-1)
    count = int(np.count_nonzero(bad))
    if count:
        row, column = np.argwhere(bad)[0]
        where = f"the first at row {first_row + int(row)}, column {column}"
        texels = "1 texel is" if count == 1 else f"{count} texels are"
        raise problem(path, f"{texels} NaN or infinite, {where}; repair or repaint them")


def _check(path: Path, spec: oiio.ImageSpec) -> str:
    """The type to read as, after refusing what cannot be read faithfully."""
    if spec.deep:
        raise problem(path, "is a deep image; flatten it first")
    check_size(path, spec.width, spec.height)
    if spec.depth > 1:
        raise problem(path, f"is a volume of {spec.depth} slices; give a flat image")
    model = photometric(spec)
    kind = spec.get_string_attribute("jpeg:ColorSpace")
    if model == 5 or kind in ("CMYK", "YCCK"):
        raise problem(path, "is CMYK, made for print; convert it to RGB")
    if model is not None and model not in (*_RGB_PHOTOMETRICS, *_GREY_PHOTOMETRICS, _PALETTE):
        kind = str(spec.getattribute("tiff:ColorSpace") or f"photometric {model}")
        raise problem(path, f"stores another colour model ({kind}); convert it to RGB")
    for kind in {str(t) for t in (spec.format, *spec.channelformats)}:
        if kind not in STORED_AS:
            what = f"has samples of type {kind}, which cannot be kept"
            raise problem(path, f"{what}; convert it to 8 or 16 bit integer, half or float")
    return STORED_AS[str(spec.format)]


def _check_claim(path: Path, file_format: str, spec: oiio.ImageSpec, stored_as: str) -> None:
    """Refuse a header that claims more texels than its file can hold, before memory is taken."""
    texel = spec.nchannels * oiio.TypeDesc(stored_as).size()
    size = spec.image_pixels() * texel
    across, down = spec.tile_width, spec.tile_height
    if across:
        check_tile(path, across, down, across * down * spec.tile_depth * texel)
        size = -(-spec.width // across) * across * -(-spec.height // down) * down * texel
    packing = spec.get_string_attribute("compression")
    if file_format in ("tiff", "openexr") and packing not in _PACKING:
        return
    if spec.get_int_attribute("oiio:BitsPerSample", 8) < 8:
        return
    check_claim(path, spec.width, spec.height, size)


def check_memory(path: Path, spec: oiio.ImageSpec, stored_as: str) -> None:
    """Refuse to hold an image that free memory has no room for."""
    need = spec.image_pixels() * spec.nchannels * oiio.TypeDesc(stored_as).size()
    free = available_memory()
    if free is not None and need > free:
        what = f"needs {need / 2**30:.1f} GiB of memory, {free / 2**30:.1f} GiB is free"
        raise problem(path, f"{what}; close other programs or split it into tiles")


def available_memory() -> int | None:
    """Bytes of memory that can be had without swapping; None where the system does not say."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            fields = dict(line.split(":", 1) for line in file)
        return int(fields["MemAvailable"].split()[0]) * 1024
    except (OSError, KeyError, ValueError):
        pass
    try:
        return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None


def _unreadable(path: Path, error: str) -> Exception:
    first = next((line.strip() for line in error.splitlines() if line.strip()), "")
    if "image size" in first and "exceeds" in first:
        return problem(path, f"is too large ({first}); split it into tiles")
    detail = f" ({shorten(first)})" if first else ""
    return problem(path, f"is damaged or truncated{detail}; copy or export it again")
