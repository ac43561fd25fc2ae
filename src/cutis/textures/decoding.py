"""The one way in through OpenImageIO: stored values of any supported file, verbatim."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.textures.headers import check_size, image_format
from cutis.textures.problem import check_name, problem

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


@dataclass(frozen=True, eq=False)
class Decoded:
    """`pixels` (H, W, C) as they are stored: uint8, uint16, float16 or float32."""

    pixels: NDArray[np.generic]
    spec: oiio.ImageSpec
    format: str


def decode(path: Path) -> Decoded:
    """First image of a PNG, JPEG, TIFF or OpenEXR file.

    Raises CutisError, in one line, for a file that is missing or not whole, too large, deep, CMYK,
    or of a sample type that cannot be kept.
    """
    image_format(path)
    check_name(path)
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)  # leave alpha alone, whichever way it is stored
    source = oiio.ImageInput.open(str(path), hints)
    if source is None:
        raise _unreadable(path, pending_error())
    try:
        spec = source.spec()
        "".join(spec.channelnames).encode()  # bytes that are not UTF-8 come as lone surrogates
        stored_as = _check(path, spec)
        pixels = source.read_image(0, 0, 0, spec.nchannels, stored_as)
        # JPEG gives a full array, grey where the data ended, and says so only here.
        error = pending_error(source)
        if pixels is None or error:
            raise _unreadable(path, error)
        pixels = np.asarray(pixels).reshape(spec.height, spec.width, spec.nchannels)
        return Decoded(pixels, spec.copy(), source.format_name())
    except UnicodeError as cause:
        raise problem(path, "is damaged: a name in it is not text; export it again") from cause
    finally:
        source.close()
        pending_error(source)


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
    value = spec.getattribute("tiff:PhotometricInterpretation")
    return None if value is None else int(value)


def is_palette(spec: oiio.ImageSpec) -> bool:
    """Whether a TIFF stores indices into a palette, which OpenImageIO has expanded to RGB."""
    return photometric(spec) == _PALETTE


def check_finite(path: Path, values: NDArray[np.generic]) -> None:
    """Refuse NaN and infinity in `values` (H, W, C), naming how many texels and where the first."""
    if values.dtype.kind != "f":
        return
    count, first = 0, (0, 0)
    for top in range(0, len(values), 256):
        bad = ~np.isfinite(values[top : top + 256]).all(axis=-1)
        if bad.any() and not count:
            row, column = np.argwhere(bad)[0]
            first = (top + int(row), int(column))
        count += int(np.count_nonzero(bad))
    if count:
        where = f"the first at row {first[0]}, column {first[1]}"
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
    if model == 5 or spec.getattribute("jpeg:ColorSpace") in ("CMYK", "YCCK"):
        raise problem(path, "is CMYK, made for print; convert it to RGB")
    if model is not None and model not in (*_RGB_PHOTOMETRICS, *_GREY_PHOTOMETRICS, _PALETTE):
        kind = spec.getattribute("tiff:ColorSpace") or f"photometric {model}"
        raise problem(path, f"stores another colour model ({kind}); convert it to RGB")
    for kind in {str(t) for t in (spec.format, *spec.channelformats)}:
        if kind not in STORED_AS:
            what = f"has samples of type {kind}, which cannot be kept"
            raise problem(path, f"{what}; convert it to 8 or 16 bit integer, half or float")
    stored_as = STORED_AS[str(spec.format)]
    need = spec.image_pixels() * spec.nchannels * oiio.TypeDesc(stored_as).size()
    free = available_memory()
    if free is not None and need > free:
        what = f"needs {need / 2**30:.1f} GiB of memory, {free / 2**30:.1f} GiB is free"
        raise problem(path, f"{what}; close other programs or split it into tiles")
    return stored_as


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
    detail = f" ({first})" if first else ""
    return problem(path, f"is damaged or truncated{detail}; copy or export it again")
