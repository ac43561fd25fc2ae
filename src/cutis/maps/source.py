"""Captures: what maps are estimated of and written back into, in memory or in files."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from cutis.colour.spaces import Space
from cutis.errors import CutisError
from cutis.maps.plain import Map
from cutis.textures import MaskFile, Orientation, Texture, TextureFile, bands


class Capture(Protocol):
    """Colours (linear sRGB) and where on them skin is, some rows at a time."""

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""

    @property
    def rounding(self) -> float:
        """Step that encoded colours are rounded to: 1/255 of 8-bit files, 0 where none is known."""

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it, in an order that is good to read in."""

    def rows(self, rows: slice) -> tuple[Map, Map]:
        """Colours (h, W, 3) and cover (h, W) in [0, 1] of some rows."""


class ArrayCapture:
    """A capture in memory: `colours` (H, W, 3), `cover` (H, W) and the step of encoded colours."""

    def __init__(self, colours: Map, cover: Map, rounding: float = 0.0) -> None:
        self.colours, self.cover, self.rounding = colours, cover, rounding

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.cover.shape[0], self.cover.shape[1]

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it."""
        return bands(self.shape)

    def rows(self, rows: slice) -> tuple[Map, Map]:
        """Colours and cover of some rows."""
        return self.colours[rows], self.cover[rows]


class FileCapture:
    """A capture in an open file, with its open mask; without a mask, alpha says where skin is.

    `seen` becomes true where skin was met in the rows that were read. `watched` is shown all that
    is read: the first row, the rows as they are stored, their colours and cover.
    """

    def __init__(self, texture: TextureFile, mask: MaskFile | None = None) -> None:
        self.texture, self.mask, self.seen = texture, mask, False
        self.watched: Callable[[int, Texture, Map, Map], None] | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.texture.shape

    @property
    def rounding(self) -> float:
        """Step that encoded colours are rounded to."""
        return rounding_of(self.texture.space, self.texture.eight_bits)

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover it."""
        return self.texture.bands()

    def rows(self, rows: slice) -> tuple[Map, Map]:
        """Colours and cover of some rows."""
        part = self.texture.rows(rows)
        least = 0.0 if self.mask is None else MaskFile.BLACK
        cover = cover_of_alpha(part) if self.mask is None else self.mask.rows(rows)
        self.seen = self.seen or bool((cover > least).any())
        colours = part.linear()
        if self.watched is not None:
            self.watched(rows.start, part, colours, cover)
        return colours, cover

    def empty(self) -> CutisError:
        """What to raise when no skin was met."""
        if self.mask is not None:
            return self.mask.empty()
        return CutisError(f"{self.texture.path}: all of it is transparent, so that nothing is skin")


def cover_of_alpha(part: Texture) -> Map:
    """(h, W): 1 where a texture is not transparent, else 0."""
    alpha = part.alpha()
    return np.ones(part.shape, np.float32) if alpha is None else (alpha > 0).astype(np.float32)


def rounding_of(space: Space, eight_bits: bool) -> float:
    """Step of encoded colours in a file of 8 bits, 0 of any finer and of linear ones."""
    return 1 / 255 if space.encoded and eight_bits else 0.0


def in_memory(face: Texture | ArrayLike, mask: ArrayLike | None) -> ArrayCapture:
    """The capture of a texture or of an (H, W, 3) array of linear sRGB, with its mask (H, W).

    Raises CutisError for arrays of other shapes, NaN or infinite colours, and masks that are empty,
    out of range or of another size.
    """
    colours = face.linear() if isinstance(face, Texture) else _linear(face)
    shape = colours.shape[:2]
    if mask is not None:
        cover = np.array(mask, dtype=np.float32)
    elif isinstance(face, Texture):
        cover = cover_of_alpha(face)
    else:
        cover = np.ones(shape, np.float32)
    if cover.shape != shape:
        raise CutisError(f"the mask is {cover.shape}, the albedo is {tuple(shape)}")
    if not (np.isfinite(cover).all() and cover.min() >= 0 and cover.max() <= 1):
        raise CutisError("the mask must hold values from 0 to 1")
    if not (cover > 0).any():
        raise CutisError("the mask is empty: nothing is marked as skin")
    rounding = 0.0
    if isinstance(face, Texture):
        rounding = rounding_of(face.space, face.pixels.dtype == np.uint8)
    return ArrayCapture(colours, cover, rounding)


def _linear(face: ArrayLike) -> Map:
    colours = np.asarray(face)
    if colours.ndim == 2 and colours.shape[-1] == 3:
        raise CutisError(
            "an (n, 3) list of colours has no texels beside each other: give it to "
            "cutis.load_model().encode, or as (1, n, 3)"
        )
    if colours.ndim != 3 or colours.shape[2] != 3 or colours.size == 0:
        raise CutisError(f"an albedo must be (H, W, 3) linear sRGB, not {colours.shape}")
    if colours.dtype.kind not in "f":
        raise CutisError(
            f"an albedo array must be floating-point linear sRGB, not {colours.dtype}; "
            "decode it first, or give a file to cutis.read"
        )
    with np.errstate(over="ignore"):
        linear = colours.astype(np.float32)  # a copy: what happens to the array later is not seen
    if not all(np.isfinite(linear[rows]).all() for rows in bands(linear.shape[:2])):
        raise CutisError("the albedo has NaN or infinite texels; repair them first")
    return linear


# which capture maps are of -----------------------------------------------------------------------


def source_note(source: TextureFile | Texture) -> dict[str, str]:
    """Provenance of a capture: its whole path, SHA-256, and how it was read: space, orientation.

    Maps store the path as seen from their folder. `window` tells where its texels lie on its
    picture, if they are not all of it. Empty without a file.
    """
    if source.path is None or not source.path.is_file():
        return {}
    note = {
        "source": source.path.resolve().as_posix(),
        "source_sha256": digest(source.path),
        "source_colorspace": source.space.name if source.origin == "given" else "auto",
        "source_orientation": "ignore" if source.orientation == "ignore" else str(source.turned),
    }
    if not source.frame.whole:
        note["window"] = source.frame.note()
    config = getattr(source.space, "config", None)
    if not config or source.origin != "given":
        return note
    return {**note, "source_ocio": config if "://" in config else Path(config).resolve().as_posix()}


def open_source(provenance: Mapping[str, str], capture: Path, shown: bool = False) -> TextureFile:
    """The capture that maps were made from, opened and understood as it was then.

    With `shown` its rows are those of the whole picture (`TextureFile`).
    """
    space = provenance.get("source_colorspace", "auto")
    # the configuration of then, or none: $OCIO may have changed since
    config, turning = provenance.get("source_ocio", ""), orientation_of(provenance)
    return TextureFile(capture, space, config, turning, shown)


def orientation_of(provenance: Mapping[str, str]) -> Orientation:
    """How the capture of maps is to be turned; until version 0.1 it was not."""
    before = "source" in provenance and "source_orientation" not in provenance
    return "ignore" if before or provenance.get("source_orientation") == "ignore" else "auto"


def find_source(provenance: Mapping[str, str], maps_path: Path, given: Path | None = None) -> Path:
    """The capture that maps were made from: `given`, or what their provenance names.

    Raises CutisError when it is gone or has changed since.
    """
    name = provenance.get("source")
    if given is None and name is None:
        raise CutisError(f"{maps_path.name} does not name its capture; give it with --source")
    beside = maps_path.parent
    candidates = [given] if given else [beside / str(name), beside / Path(str(name)).name]
    present = [candidate for candidate in candidates if candidate.is_file()]
    expected = provenance.get("source_sha256")
    for candidate in present:
        if expected is None or digest(candidate) == expected:
            return candidate
    if present:
        raise CutisError(
            f"{present[0].name} has changed since {maps_path.name} was made; "
            "estimate again, or give the original with --source"
        )
    raise CutisError(
        f"the capture {candidates[0]} of {maps_path.name} is missing; give it with --source"
    )


def digest(path: Path) -> str:
    """SHA-256 of a file, hexadecimal; read once for as long as the file is what it was."""
    now = path.stat()
    key = (now.st_dev, now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns)
    return _digest(path, key)


@lru_cache(maxsize=4096)
def _digest(path: Path, _: tuple[int, ...]) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
