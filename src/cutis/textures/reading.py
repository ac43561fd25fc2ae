"""RGB textures from image files, whole or some rows at a time."""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from cutis.colour.spaces import Space
from cutis.errors import CutisError
from cutis.textures.closing import Closing
from cutis.textures.decoding import Decoder, check_finite, check_memory, is_palette, photometric
from cutis.textures.headers import stored_otherwise
from cutis.textures.problem import problem
from cutis.textures.spaces import colour_space, declared_space
from cutis.textures.texture import Texture, bands, colour_channels


class TextureFile(Closing):
    """An open texture: what its header says, and its rows on demand.

    See `read_texture` for what is read and how, and for errors, which may show only at the rows
    concerned. Close it, or use it in a with block.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        colorspace: str | Space = "auto",
        ocio: str | None = None,
    ) -> None:
        self.path = Path(path)
        self._source = Decoder(self.path)
        try:
            self._describe(colorspace, ocio)
        except ValueError as error:
            self.close()
            raise error if isinstance(error, CutisError) else problem(path, str(error)) from error

    def _describe(self, colorspace: str | Space, ocio: str | None) -> None:
        spec, path = self._source.spec, self.path
        self.spec: oiio.ImageSpec = spec
        self.format = self._source.file_format
        self.shape = self._source.shape
        self.channels = tuple(spec.channelnames)
        stored = stored_otherwise(path, self.format)
        if is_palette(spec) or stored == "palette":
            raise problem(path, "stores a palette of at most 256 colours; convert it to RGB")
        if spec.nchannels < 3 or photometric(spec) in (0, 1) or stored == "grey":
            raise problem(path, "is a grey image; an RGB image is needed, so convert it")
        try:
            rgb, alpha = colour_channels(spec.channelnames)
        except ValueError as error:
            raise problem(path, str(error)) from error
        self._checked = rgb if alpha is None else [*rgb, alpha]
        self.associated = alpha is not None and not spec.get_int_attribute("oiio:UnassociatedAlpha")
        if colorspace == "auto":
            self.space, self.origin = declared_space(
                spec, self.format, self._source.dtype.kind == "f"
            )
        else:
            given = colour_space(colorspace, ocio) if isinstance(colorspace, str) else colorspace
            self.space, self.origin = given, "given"

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the texture, of about half a million texels each."""
        return bands(self.shape, self._source.step)

    def rows(self, rows: slice) -> Texture:
        """The texture of some rows; CutisError where they are damaged, NaN or infinite."""
        top, bottom, _ = rows.indices(self.shape[0])
        if bottom > top:
            pixels = self._source.rows(rows)
            for column in self._checked:
                check_finite(self.path, pixels[..., column : column + 1], top)
        else:
            pixels = np.empty((0, self.shape[1], len(self.channels)), self._source.dtype)
        return Texture(
            pixels, self.channels, self.space, self.path, self.spec, self.format, self.associated,
            self.origin,
        )  # fmt: skip

    def read(self) -> Texture:
        """All rows; CutisError also where memory has no room for them."""
        check_memory(self.path, self.spec, self._source.stored_as)
        return self.rows(slice(None))


def read_texture(
    path: str | os.PathLike[str], colorspace: str | Space = "auto", ocio: str | None = None
) -> Texture:
    """The texture in a file, in its stored type and with all its channels and metadata.

    `colorspace` is or names the space of the colours (`textures.colour_space`), in the OpenColorIO
    configuration `ocio` if given. With "auto" the file's ICC profile, chromaticities or colour
    tag count; without any, integers are encoded sRGB and floats linear sRGB.
    10 and 12 bit files come as uint16, double as float32. Of an OpenEXR file of several parts the
    first is read. EXIF orientation is kept as metadata; texels stay in stored order.

    Raises CutisError, one line that names the file, for anything that is not a whole RGB image of
    at most 32768 × 32768 texels: missing, damaged, grey, palette, CMYK, deep, NaN or infinite
    colours, more than memory holds; and for colour profiles that are no matrix with curves.
    Colours below 0 or above 1 are fine.
    """
    with TextureFile(path, colorspace, ocio) as file:
        return file.read()
