"""Textures to image files, whole or some rows at a time."""

import contextlib
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cutis.colour.spaces import SRGB, Space
from cutis.errors import CutisError
from cutis.textures.curves import CurveSpace
from cutis.textures.encoding import Encoder, encoder
from cutis.textures.frame import Frame, placed
from cutis.textures.limits import check_size
from cutis.textures.problem import problem
from cutis.textures.spaces import sibling
from cutis.textures.specs import header
from cutis.textures.texture import Texture, bands, colour_channels, from_unit, to_unit
from cutis.textures.turning import as_stored

FORMATS = {
    ".png": "png",
    ".jpg": "jpeg",
    ".jpeg": "jpeg",
    ".tif": "tiff",
    ".tiff": "tiff",
    ".exr": "openexr",
    ".tx": "tx",
    ".dpx": "dpx",
}
# What each format stores a type as, and how many channels it takes.
_STORED_AS = {
    "png": {"float16": "uint16", "float32": "uint16"},
    "jpeg": {"uint16": "uint8", "float16": "uint8", "float32": "uint8"},
    "tiff": {"float16": "float32"},
    "openexr": {"uint8": "float16", "uint16": "float32"},
    "tx": {"float16": "float32"},
    "dpx": {"float16": "uint16", "float32": "uint16"},
}
_MOST_CHANNELS = {"png": 4, "jpeg": 3, "dpx": 4}
# These know only colour that is multiplied by alpha.
_ASSOCIATED = ("openexr", "dpx", "tx")


class Source(Protocol):
    """A texture in memory or in a file."""

    @property
    def frame(self) -> Frame:
        """Where its texels lie on the picture."""

    def rows(self, rows: slice) -> Texture:
        """The texture of some rows."""


def write_texture(
    texture: Texture, path: str | os.PathLike[str], space: Space | None = None
) -> None:
    """Write a texture in the format that the extension names, with its metadata.

    Written back in the format it came from, a texture keeps its stored values bit for bit (JPEG
    aside, which is lossy), its channels, type, compression where lossless, tiles, and metadata.
    Else:

    * PNG and DPX take float as 16 bit sRGB, JPEG everything as 8 bit at quality 98, TIFF float16 as
      float32, OpenEXR uint8 as half and uint16 as float, both made linear and associated;
    * PNG and DPX keep only R, G, B and A, JPEG only R, G, B;
    * .tx is a TIFF of 64 × 64 tiles with all MIP levels, associated, for renderers;
    * an ICC profile is kept where the colour space is (DPX and OpenEXR hold none, so OpenEXR gets
      linear values and chromaticities, and DPX sRGB). Other RGB spaces get a profile of ours.

    `space` is the colour space to write; by default that of the texture, linear in OpenEXR. 8 bits
    become 16 where a linear space is asked for.

    OpenEXR keeps data and display window; the other formats hold the display window, the picture:
    what is outside is cut off, and where nothing is stored they are black and transparent. A
    picture that was stored turned is turned so again in its own format, and upright in others.

    Of a file of several pictures only one was read, so only that is written. EXIF of the camera
    survives in JPEG and PNG, not in TIFF, where OpenImageIO does not reach it.

    Raises CutisError, one line that names the file, for an unknown extension or a failed write (a
    file that was there is then untouched), and for what is no texture.
    """
    if not isinstance(texture, Texture):
        raise CutisError(
            "only a texture can be written; put an array of linear sRGB into the one that it came "
            "from: face.with_linear(array, mask > 0)"
        )
    with texture_writer(path, texture, space) as writer:
        for rows in bands(texture.shape):
            writer.write(texture.rows(rows))


class TextureWriter:
    """A texture file in the making; see `texture_writer`."""

    def __init__(
        self, sink: Encoder, file_format: str, space: Space | None, frame: Frame, into: Frame
    ) -> None:
        self._sink, self._format, self._space = sink, file_format, space
        self._frame, self._into = frame, into
        self._turned: list[NDArray[np.generic]] = []  # rows of a picture that is stored turned
        self._came = self._written = 0  # rows of the texture, rows of the file

    def write(self, part: Texture) -> None:
        """The next rows, from top to bottom."""
        pixels = _fitted(part, self._format, self._space).pixels
        if part.turned != 1 and part.format == self._format:
            self._turned.append(pixels)
            if sum(map(len, self._turned)) == self._frame.shape[0]:
                self._sink.write(as_stored(np.concatenate(self._turned), part.turned))
            return
        if self._frame == self._into:
            self._sink.write(pixels)
            return
        top = self._frame.top + self._came
        here = replace(self._frame, shape=(len(pixels), self._frame.shape[1]), top=top)
        self._came += len(pixels)
        height, width = self._into.shape
        last = self._came == self._frame.shape[0]
        known = height if last else min(max(self._written, top + len(pixels)), height)
        for rows in bands((known - self._written, width)):
            first = self._written + rows.start
            wanted = slice(first, min(self._written + rows.stop, known))
            self._sink.write(placed(lambda there: pixels[there], here, self._into, wanted))
        self._written = known


@contextlib.contextmanager
def texture_writer(
    path: str | os.PathLike[str], like: Source, space: Space | None = None
) -> Iterator[TextureWriter]:
    """A writer of rows like those of `like`, as `write_texture` writes them.

    The file has its final name when the block ends well; else nothing is left of it. Raises as
    `write_texture` does.
    """
    path, frame = Path(path), like.frame
    file_format = format_of(path)
    blank = like.rows(slice(0, 0))
    into = frame if file_format == "openexr" else frame.shown
    if not (into == frame or frame.visible):
        what = "the texture lies outside its display window, which is all that such a file holds"
        raise problem(path, f"{what}; write OpenEXR")
    check_size(path, into.shape[1], into.shape[0])
    spec = header(blank, _fitted(blank, file_format, space), file_format, into)
    with encoder(path, file_format, spec) as sink:
        yield TextureWriter(sink, file_format, space, frame, into)


def format_of(path: Path) -> str:
    """OpenImageIO's name of the format that `write_texture` would write.

    Raises CutisError for an unknown extension or a folder that is not there, so that a command can
    ask before it works.
    """
    file_format = FORMATS.get(path.suffix.lower())
    if file_format is None:
        known = ", ".join(FORMATS)
        raise problem(path, f"has an extension that is none of {known}; choose one of these")
    if not path.parent.is_dir():
        raise problem(path, f"the folder {path.parent} does not exist; create it first")
    return file_format


def _fitted(texture: Texture, file_format: str, wanted: Space | None) -> Texture:
    """The texture as `file_format` can store it; the same one where nothing needs to change."""
    old = texture.pixels.dtype
    same = file_format == texture.format
    dtype = old if same else np.dtype(_STORED_AS[file_format].get(old.name, old.name))
    space = wanted or texture.space
    if wanted is None and dtype.kind != old.kind:
        space = sibling(space, dtype.kind != "f")
    if not same:
        if wanted is None and file_format == "openexr":
            space = sibling(space, False)
        if wanted is None and file_format == "dpx" and isinstance(space, CurveSpace):
            space = SRGB
        texture = _arranged(texture, _MOST_CHANNELS.get(file_format))
    if dtype == np.uint8 and file_format != "jpeg" and texture.space.encoded and not space.encoded:
        dtype = np.dtype(np.uint16)
    _, alpha = colour_channels(texture.channels)
    associated = alpha is not None and (
        file_format in _ASSOCIATED or (file_format == "tiff" and texture.associated)
    )
    if (dtype, space, associated) == (old, texture.space, texture.associated):
        return texture
    pixels = np.empty(texture.pixels.shape, dtype)
    for rows in bands(texture.shape):
        pixels[rows] = from_unit(to_unit(texture.pixels[rows]), dtype)
    blank = Texture(pixels, texture.channels, space, associated=associated)
    return blank.with_linear(texture.linear(), np.ones(texture.shape, bool))


def _arranged(texture: Texture, most: int | None) -> Texture:
    """Channels in the order R, G, B, A, others, under these names, the first `most` of them."""
    rgb, alpha = colour_channels(texture.channels)
    first = [*rgb, *([] if alpha is None else [alpha])]
    others = [column for column in range(len(texture.channels)) if column not in first]
    columns = [*first, *others][:most]
    names = [*"RGBA"[: len(first)], *(texture.channels[column] for column in others)][:most]
    if columns == list(range(len(texture.channels))):
        return replace(texture, channels=tuple(names))
    associated = texture.associated and "A" in names
    colour = texture.linear() if texture.associated and not associated else None
    pixels = texture.pixels[..., columns]
    out = replace(texture, pixels=pixels, channels=tuple(names), associated=associated)
    return out if colour is None else out.with_linear(colour, np.ones(out.shape, bool))
