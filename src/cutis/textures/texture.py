"""A texture as it is stored, and as linear colour."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spaces import RGBSpace, Space
from cutis.colour.transfer import decode_srgb
from cutis.errors import CutisError
from cutis.textures.frame import Frame, frame_of, whole_frame
from cutis.textures.problem import shorten
from cutis.textures.turning import Orientation

STORED_TYPES = ("uint8", "uint16", "float16", "float32")
_BAND = 1 << 19  # texels at a time: about 50 MB of temporaries
_LARGEST = {"uint8": np.float32(255), "uint16": np.float32(65535)}
_TRANSPARENT = 1e-6  # no colour can be told from a product with less alpha


@dataclass(frozen=True, eq=False)
class Texture:
    """Stored values of an RGB image and what is needed to read them as colour.

    `pixels` (H, W, C) is uint8, uint16, float16 or float32; `channels` names the C columns, among
    them one set of R, G, B, found by name (`diffuse.R` counts where it is the only set). `space` is
    the colour space of the stored values and `origin` says in words how it is known. `spec`
    holds the metadata of the file it came from and `format` OpenImageIO's name of that format.
    `associated` says that stored colour is multiplied by alpha, `turned` how the file has the
    picture turned, as Exif numbers it, while `pixels` are upright, and `orientation` whether its
    tag counted. Raises CutisError if these do not fit together.
    """

    pixels: NDArray[np.generic]
    channels: tuple[str, ...]
    space: Space
    path: Path | None = None
    spec: oiio.ImageSpec | None = None
    format: str | None = None
    associated: bool = False
    origin: str = "given"
    turned: int = 1
    orientation: Orientation = "auto"

    def __post_init__(self) -> None:
        if self.pixels.ndim != 3 or self.pixels.shape[2] != len(self.channels):
            shape, names = self.pixels.shape, len(self.channels)
            raise CutisError(f"pixels must be (H, W, {names}) for {names} channels, not {shape}")
        if self.pixels.dtype.name not in STORED_TYPES:
            types = ", ".join(STORED_TYPES)
            raise CutisError(f"pixels must be one of {types}, not {self.pixels.dtype}")
        colour_channels(self.channels)

    def __repr__(self) -> str:
        height, width = self.shape
        name = "" if self.path is None else f" {self.path.name},"
        return (
            f"<texture{name} {width} × {height} {self.pixels.dtype} {','.join(self.channels)} in "
            f"{self.space.name} ({self.origin})>"
        )

    def _repr_html_(self) -> str:
        """A thumbnail, for notebooks."""
        from cutis.textures.thumbnail import LONGEST, picture_html

        step = max(1, -(-max(self.shape) // LONGEST))
        return picture_html(replace(self, pixels=self.pixels[::step, ::step]).linear(), repr(self))

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.pixels.shape[0], self.pixels.shape[1]

    @property
    def frame(self) -> Frame:
        """Where its texels lie on the picture: as its header says, if that is of all its rows."""
        if self.spec is not None and (self.spec.height, self.spec.width) == self.shape:
            return frame_of(self.spec, self.format or "")
        return whole_frame(self.shape)

    def rows(self, rows: slice) -> "Texture":
        """The texture of some rows only."""
        return replace(self, pixels=self.pixels[rows])

    def linear(self) -> NDArray[np.float32]:
        """Colour (H, W, 3), linear sRGB, straight (not multiplied by alpha), not clamped."""
        colour = np.empty((*self.shape, 3), np.float32)
        for rows in bands(self.shape):
            colour[rows] = self.rows(rows)._linear()
        return colour

    def _linear(self) -> NDArray[np.float32]:
        rgb, _ = colour_channels(self.channels)
        stored = self.pixels[..., rgb]
        ours = isinstance(self.space, RGBSpace)
        if stored.dtype.kind == "u" and not self.associated and ours:
            assert isinstance(self.space, RGBSpace)
            linear = _decoding_table(stored.dtype.name, self.space.encoded)[stored]
            return self.space.primaries_to_srgb(linear).astype(np.float32, copy=False)
        values = to_unit(stored)
        alpha = self._factor()
        if alpha is not None:
            values /= alpha[..., None]
        return self.space.to_linear_srgb(values).astype(np.float32, copy=False)

    def alpha(self) -> NDArray[np.float32] | None:
        """Opacity (H, W), 1 is opaque; None without an alpha channel."""
        _, column = colour_channels(self.channels)
        return None if column is None else to_unit(self.pixels[..., column])

    def with_linear(self, rgb: ArrayLike, where: ArrayLike) -> "Texture":
        """A copy whose colour is `rgb` (H, W, 3), linear sRGB, where `where` (H, W) is True.

        Integers are rounded to the nearest and clamped, float16 is clamped to its range. All
        other stored values, among them alpha and further channels, are the same bit for bit.
        Raises CutisError for shapes that do not fit and for NaN or infinite colours to be stored.
        """
        colour, chosen = np.asarray(rgb), np.asarray(where)
        if colour.shape != (*self.shape, 3) or chosen.shape != self.shape:
            sizes = f"rgb is {colour.shape} and where is {chosen.shape}"
            raise CutisError(f"{sizes}; a texture of {self.shape} needs {(*self.shape, 3)} and it")
        if chosen.dtype != np.bool_:
            raise CutisError(f"where must be boolean, not {chosen.dtype}; compare the mask first")
        pixels = self.pixels.copy()
        columns, _ = colour_channels(self.channels)
        for rows in bands(self.shape):
            inside = chosen[rows]
            if inside.any():
                alpha = self.rows(rows)._factor()
                new = self._encoded(colour[rows][inside], None if alpha is None else alpha[inside])
                for column, values in zip(columns, new.T, strict=True):
                    pixels[rows, :, column][inside] = values
        return replace(self, pixels=pixels)

    def _factor(self) -> NDArray[np.float32] | None:
        """What stored colour was multiplied by, 1 where it is transparent; None if it was not."""
        _, column = colour_channels(self.channels)
        if column is None or not self.associated:
            return None
        alpha = to_unit(self.pixels[..., column])
        return np.where(np.abs(alpha) > _TRANSPARENT, alpha, np.float32(1))

    def _encoded(
        self, colour: NDArray[np.generic], alpha: NDArray[np.float32] | None
    ) -> NDArray[np.generic]:
        """Stored values of straight linear colours (N, 3)."""
        with np.errstate(over="ignore"):
            values = colour.astype(np.float32)
        if not np.isfinite(values).all():
            raise CutisError("some of the new colours are NaN or infinite; mask them out")
        values = self.space.from_linear_srgb(values).astype(np.float32, copy=False)
        if alpha is not None:
            values *= alpha[:, None]
        return from_unit(values, self.pixels.dtype)


def bands(shape: tuple[int, int], chunk: int = 1) -> Iterator[slice]:
    """Slices of rows that cover an image of `shape` (H, W), each about half a million texels.

    All but the last hold a multiple of `chunk` rows, which files keep together.
    """
    step = max(1, _BAND // max(1, shape[1]))
    step = max(chunk, step - step % chunk)
    for top in range(0, shape[0], step):
        yield slice(top, top + step)


def colour_channels(names: Sequence[str]) -> tuple[list[int], int | None]:
    """Columns of R, G, B and, where there is one, of the alpha that belongs to them.

    Names count in either case. Plain R, G, B come first; else the one layer (`diffuse.R`, …) that
    has all three. Raises CutisError, listing the layers, if there is none or more than one.
    """
    layers: dict[str, dict[str, int]] = {}
    for column, name in enumerate(names):
        layer, _, last = name.rpartition(".")
        layers.setdefault(layer, {}).setdefault(last.lower(), column)
    complete = [layer for layer, found in layers.items() if {"r", "g", "b"} <= found.keys()]
    if "" in complete:
        complete = [""]
    if len(complete) > 1:
        listed = shorten(", ".join(sorted(complete)))
        raise CutisError(f"has colour in several layers ({listed}); keep or rename one to R, G, B")
    if not complete:
        raise CutisError(
            f"has no R, G, B channels, only {shorten(', '.join(names))}; an RGB image is needed"
        )
    found = layers[complete[0]]
    return [found["r"], found["g"], found["b"]], found.get("a")


def to_unit(stored: NDArray[np.generic]) -> NDArray[np.float32]:
    """Stored values as float32; integers become fractions of their largest, 255 or 65535."""
    values = stored.astype(np.float32)
    if stored.dtype.kind == "u":
        values /= _LARGEST[stored.dtype.name]
    return values


def from_unit(values: NDArray[np.float32], dtype: np.dtype[np.generic]) -> NDArray[np.generic]:
    """The inverse of `to_unit`, rounded to the nearest and clamped to what `dtype` holds."""
    if dtype.kind == "u":
        values = np.rint(np.clip(values, 0, 1) * _LARGEST[dtype.name])
    elif dtype == np.float16:
        limit = np.float32(np.finfo(np.float16).max)
        values = np.clip(values, -limit, limit)
    return values.astype(dtype)


@cache
def _decoding_table(dtype: str, encoded: bool) -> NDArray[np.float32]:
    """Linear value of each integer code, correctly rounded."""
    fractions = np.arange(np.iinfo(dtype).max + 1) / np.iinfo(dtype).max
    table = (decode_srgb(fractions) if encoded else fractions).astype(np.float32)
    table.flags.writeable = False
    return table
