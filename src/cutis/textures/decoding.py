"""The one way in through OpenImageIO: stored values of any supported file, rows at a time."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.textures.closing import Closing
from cutis.textures.frame import Frame, frame_of, placed
from cutis.textures.headers import Header, image_header
from cutis.textures.ifd import COMPRESSION, SUB_DIRECTORIES, SUBFILE
from cutis.textures.limits import check_claim, check_size, check_tile
from cutis.textures.parts import chosen_part
from cutis.textures.problem import check_name, problem, shorten
from cutis.textures.turning import Orientation, orientation_of, turned, upright

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
# TIFF's compressions that not every program can unpack, by their numbers.
_UNUSUAL = {
    2: "CCITT coding", 3: "CCITT coding", 4: "CCITT coding", 6: "JPEG of the old kind",
    34661: "JBIG", 34712: "JPEG 2000", 33003: "JPEG 2000", 33005: "JPEG 2000", 34887: "LERC",
    34892: "lossy JPEG of DNG", 34925: "LZMA", 50000: "Zstandard", 34926: "Zstandard",
    34927: "WebP", 50001: "WebP", 50002: "JPEG XL", 52546: "JPEG XL",
}  # fmt: skip
_NOT_SUPPORTED = re.compile(
    r"not (configured|implemented|supported)|unsupported|unknown compression", re.IGNORECASE
)
_INSTEAD = {
    "tiff": "save it with LZW or ZIP",
    "openexr": "save it with ZIP",
    "jpeg": "save it as an ordinary JPEG, or as PNG",
    **dict.fromkeys(("png", "dpx", "psd"), "export it in another way"),
}
"""What to do about a packing that cannot be unpacked."""


class Decoder(Closing):
    """The picture of an open file; `rows` gives stored values (h, W, C) from top to bottom.

    Values are uint8, uint16, float16 or float32. `step` is the number of rows that are stored
    together: bands of rows that start at multiples of it are cheapest. Memory is that of the rows
    asked for, except for formats whose decoders hold a whole image (interlaced PNG, PSD) and for
    pictures that are stored turned. Close it, or use it in a with block.

    Rows are those of the picture as viewers show it: turned as its orientation tag says (`turned`,
    1 for not at all), unless that is to be ignored. `frame` says where texels lie on it, `spec` is
    the header as it would be of an upright picture, `notes` say in words what was done. Of several
    pictures in the file the first full-size one that is `usable` is read. With `shown` the rows are
    those of the whole picture (the display window), 0 where nothing is stored.

    Raises CutisError, in one line, for a file that is missing or not whole, too large, deep, CMYK,
    or of a sample type that cannot be kept; what is not whole may show only at the rows concerned.
    """

    def __init__(
        self,
        path: Path,
        orientation: Orientation = "auto",
        usable: Callable[[oiio.ImageSpec], bool] = lambda _: True,
        shown: bool = False,
    ) -> None:
        self.path = path
        self.header = image_header(path)
        self.file_format = self.header.format
        check_name(path)
        hints = oiio.ImageSpec()
        hints.attribute("oiio:UnassociatedAlpha", 1)  # leave alpha alone, however it is stored
        source = oiio.ImageInput.open(str(path), hints)
        if source is None:
            raise _unreadable(path, pending_error(), self.header)
        self._source = source
        self._whole: NDArray[np.generic] | None = None
        self._placed: Frame | None = None
        try:
            self.part, self.notes = chosen_part(source, self.header, usable)
            self._stored: oiio.ImageSpec = source.spec().copy()
            "".join(self._stored.channelnames).encode()  # no UTF-8 comes as lone surrogates
            self.stored_as = _check(path, self._stored, self.header, self.part)
            _check_claim(path, self.file_format, self._stored, self.stored_as)
            self._turn(orientation)
            if shown:
                self._show()
        except UnicodeError as cause:
            self.close()
            raise problem(path, "is damaged: a name in it is not text; export it again") from cause
        except BaseException:
            self.close()
            raise

    def _turn(self, orientation: Orientation) -> None:
        """Decides how the picture is turned, and describes it."""
        stored = self._stored
        number, notes = orientation_of(stored, self.header, self.part, orientation)
        self.notes += notes
        self.spec = stored if number == 1 else turned(stored, number)
        self.turned = number
        self.frame = frame_of(self.spec, self.file_format)
        together = int(stored.get_int_attribute("oiio:RowsPerChunk", 1))
        self.step = stored.tile_height or min(max(1, together), stored.height)
        if number != 1:
            self.step = 1

    def _show(self) -> None:
        """Makes the picture of what is stored."""
        if not self.frame.whole:
            check_size(self.path, self.frame.display[1], self.frame.display[0])
            self._placed, self.frame = self.frame, self.frame.shown
            self.spec = self.spec.copy()
            self.frame.to(self.spec)
            self.step = 1

    def close(self) -> None:
        """Lets go of the file; a second call does nothing."""
        self._source.close()
        self._whole = None
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
        top, bottom, _ = rows.indices(self.spec.height)
        if bottom <= top:
            return np.empty((0, self.spec.width, self.spec.nchannels), self.dtype)
        if self._placed is not None:
            return placed(self._some, self._placed, self.frame, rows)
        if self.turned == 1:
            return self._rows(top, bottom)
        if self._whole is None:
            check_memory(self.path, self._stored, self.stored_as)
            self._whole = self._rows(0, self._stored.height)
        return np.ascontiguousarray(upright(self._whole, self.turned)[top:bottom])

    def _some(self, rows: slice) -> NDArray[np.generic]:
        """Rows of the data window, which may be none."""
        if rows.stop > rows.start:
            return self._rows(rows.start, rows.stop)
        return np.empty((0, self._stored.width, self._stored.nchannels), self.dtype)

    def _rows(self, top: int, bottom: int) -> NDArray[np.generic]:
        """Rows as they are stored."""
        spec, source = self._stored, self._source
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
            raise _unreadable(self.path, error, self.header, self.part)
        return np.asarray(pixels).reshape(bottom - top, spec.width, count)


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


def has_colour(spec: oiio.ImageSpec) -> bool:
    """Whether there are R, G, B channels, in one layer or several."""
    found = {name.rpartition(".")[2].lower() for name in spec.channelnames}
    return {"r", "g", "b"} <= found and photometric(spec) not in _GREY_PHOTOMETRICS


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


def _check(path: Path, spec: oiio.ImageSpec, header: Header, part: int) -> str:
    """The type to read as, after refusing what cannot be read faithfully."""
    if spec.deep:
        raise problem(path, "is a deep image; flatten it first")
    check_size(path, spec.width, spec.height)
    if spec.depth > 1:
        raise problem(path, f"is a volume of {spec.depth} slices; give a flat image")
    if header.format == "tiff" and part < len(header.pages):
        page = header.pages[part]
        if page.number(SUBFILE) & 1 and SUB_DIRECTORIES in page.tags:
            what = "holds a thumbnail, and its picture where only raw converters look"
            raise problem(path, f"{what}; develop or export it as TIFF of 16 bit")
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


def _unreadable(path: Path, error: str, header: Header, part: int = 0) -> Exception:
    first = next((line.strip() for line in error.splitlines() if line.strip()), "")
    if "image size" in first and "exceeds" in first:
        return problem(path, f"is too large ({first}); split it into tiles")
    if _NOT_SUPPORTED.search(first):
        packing = header.kind
        if header.format == "tiff" and part < len(header.pages):
            packing = _UNUSUAL.get(header.pages[part].number(COMPRESSION), "")
        packing = packing or f"a way unknown here ({shorten(first)})"
        instead = _INSTEAD[header.format]
        return problem(path, f"is packed with {packing}, which is not supported; {instead}")
    detail = f" ({shorten(first)})" if first else ""
    return problem(path, f"is damaged or truncated{detail}; copy or export it again")
