"""RGB textures from PNG, JPEG, TIFF and OpenEXR files."""

import os
from pathlib import Path
from typing import Literal

from cutis.textures.decoding import check_finite, decode, is_palette, photometric
from cutis.textures.headers import PNG_PALETTE, png_colour_type
from cutis.textures.primaries import foreign_space
from cutis.textures.problem import problem
from cutis.textures.texture import Encoding, Texture, colour_channels


def read_texture(
    path: str | os.PathLike[str], encoding: Literal["auto", "srgb", "linear"] = "auto"
) -> Texture:
    """The texture in a file, in its stored type and with all its channels and metadata.

    Integer files hold encoded sRGB and float files linear sRGB unless `encoding` says otherwise.
    10 and 12 bit files come as uint16, double as float32. Of an OpenEXR file of several parts the
    first is read. EXIF orientation is kept as metadata; texels stay in stored order.

    Raises CutisError, one line that names the file, for anything that is not a whole RGB image of
    at most 32768 × 32768 texels: missing, damaged, grey, palette, CMYK, deep, NaN or infinite
    colours, more than memory holds; and, unless `encoding` is given, for files that say that their
    RGB is not sRGB's (chromaticities, ICC profile). Colours below 0 or above 1 are fine: see
    `out_of_range`.
    """
    path = Path(path)
    decoded = decode(path)
    spec, pixels = decoded.spec, decoded.pixels
    if is_palette(spec) or (decoded.format == "png" and png_colour_type(path) == PNG_PALETTE):
        raise problem(path, "stores a palette of at most 256 colours; convert it to RGB")
    if spec.nchannels < 3 or photometric(spec) in (0, 1):
        raise problem(path, "is a grey image; an RGB image is needed, so convert or re-export it")
    try:
        rgb, alpha = colour_channels(spec.channelnames)
    except ValueError as error:
        raise problem(path, str(error)) from error
    for column in rgb if alpha is None else (*rgb, alpha):
        check_finite(path, pixels[..., column : column + 1])
    if encoding == "auto":
        space = foreign_space(spec)
        if space is not None:
            raise problem(
                path,
                f"holds {space}, not sRGB; convert it to sRGB or linear Rec.709, "
                "or give --encoding srgb or linear to read it as it is",
            )
        chosen: Encoding = "linear" if pixels.dtype.kind == "f" else "srgb"
    else:
        chosen = encoding
    associated = alpha is not None and not spec.get_int_attribute("oiio:UnassociatedAlpha")
    return Texture(pixels, tuple(spec.channelnames), chosen, path, spec, decoded.format, associated)
