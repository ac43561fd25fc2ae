"""RGB textures from image files, whole or some rows at a time."""

import os
from collections.abc import Iterator
from pathlib import Path

import OpenImageIO as oiio

from cutis.colour.spaces import Space
from cutis.errors import CutisError
from cutis.textures.closing import Closing
from cutis.textures.declared import declared_space
from cutis.textures.decoding import (
    Decoder,
    check_finite,
    check_memory,
    has_colour,
    is_palette,
    photometric,
)
from cutis.textures.problem import problem
from cutis.textures.spaces import colour_space
from cutis.textures.texture import Texture, bands, colour_channels
from cutis.textures.turning import Orientation


class TextureFile(Closing):
    """An open texture: what its header says, and its rows on demand.

    See `read_texture` for what is read and how, and for errors, which may show only at the rows
    concerned. `notes` say in words what was chosen or not believed. With `shown` the rows of an
    OpenEXR are those of its display window, 0 where nothing is stored. Close it, or use it in a
    with block.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        colorspace: str | Space = "auto",
        ocio: str | None = None,
        orientation: Orientation = "auto",
        shown: bool = False,
    ) -> None:
        self.path, self.orientation = Path(path), orientation
        self._source = Decoder(self.path, orientation, has_colour, shown)
        try:
            self._describe(colorspace, ocio)
        except ValueError as error:
            self.close()
            raise error if isinstance(error, CutisError) else problem(path, str(error)) from error

    def _describe(self, colorspace: str | Space, ocio: str | None) -> None:
        spec, path = self._source.spec, self.path
        self.spec: oiio.ImageSpec = spec
        self.format = self._source.file_format
        self.frame, self.turned = self._source.frame, self._source.turned
        self.shape = self._source.shape
        self.notes = list(self._source.notes)
        self.channels = tuple(spec.channelnames)
        stored = self._source.header.stored
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
            self.space, self.origin, notes = declared_space(
                spec, self._source.header, self._source.part, self._source.dtype.kind == "f"
            )
            self.notes += notes
        else:
            given = colour_space(colorspace, ocio) if isinstance(colorspace, str) else colorspace
            self.space, self.origin = given, "given"
            config = getattr(given, "config", None)
            if config:
                self.notes.append(f"its colour space {given.name} is that of {config}")

    @property
    def eight_bits(self) -> bool:
        """Whether values are stored in 8 bits."""
        return self._source.dtype.name == "uint8"

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the texture, of about half a million texels each."""
        return bands(self.shape, self._source.step)

    def rows(self, rows: slice) -> Texture:
        """The texture of some rows; CutisError where they are damaged, NaN or infinite."""
        top, bottom, _ = rows.indices(self.shape[0])
        pixels = self._source.rows(rows)
        for column in self._checked if bottom > top else ():
            check_finite(self.path, pixels[..., column : column + 1], top)
        return Texture(
            pixels, self.channels, self.space, self.path, self.spec, self.format, self.associated,
            self.origin, self._source.turned, self.orientation,
        )  # fmt: skip

    def read(self) -> Texture:
        """All rows; CutisError also where memory has no room for them."""
        check_memory(self.path, self.spec, self._source.stored_as)
        return self.rows(slice(None))


def read_texture(
    path: str | os.PathLike[str],
    colorspace: str | Space = "auto",
    ocio: str | None = None,
    orientation: Orientation = "auto",
) -> Texture:
    """The texture in a file, in its stored type and with all its channels and metadata.

    `colorspace` is or names the space of the colours (`textures.colour_space`), in the OpenColorIO
    configuration `ocio` if given. With "auto" what the file says counts (`declared_space`); where
    it says nothing, integers are encoded sRGB and floats linear sRGB. 10 and 12 bit files come as
    uint16, double as float32. Of several pictures in a file the first full-size one in RGB is read.
    It comes as viewers show it, turned as its orientation tag says, unless `orientation` is
    "ignore"; the tag is kept as metadata.

    Raises CutisError, one line that names the file, for anything that is not a whole RGB image of
    at most 32768 × 32768 texels: missing, damaged, grey, palette, CMYK, deep, NaN or infinite
    colours, more than memory holds; and for colour profiles that are no matrix with curves.
    Colours below 0 or above 1 are fine.
    """
    with TextureFile(path, colorspace, ocio, orientation) as file:
        return file.read()
