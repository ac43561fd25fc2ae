"""The one way out through OpenImageIO: an image under its final name whole, or not at all."""

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.textures.atomic import replacing
from cutis.textures.decoding import pending_error
from cutis.textures.mip import Pyramid
from cutis.textures.png import check_png
from cutis.textures.problem import check_name, problem, reason

# libtiff is asked for an empty EXIF block and declines; the image is complete all the same.
_HARMLESS = {"failed TIFFWriteCustomDirectory() of the Exif data"}

Pixels = NDArray[np.generic]
TILE = 64
"""Texels along a side of a tile of a texture for renderers, as is usual."""
_BIG = 3 << 30  # bytes; with their levels such textures pass the 4 GiB of a plain TIFF
_DTYPES = {"uint8": "uint8", "uint16": "uint16", "half": "float16", "float": "float32"}


def encode(path: Path, file_format: str, spec: oiio.ImageSpec, pixels: Pixels) -> None:
    """Write `pixels` (H, W, C) as `spec` says in a format of `headers.SIGNATURES`, or "tx".

    Raises CutisError, one line that names the file, and leaves `path` as it was.
    """
    with encoder(path, file_format, spec) as sink:
        sink.write(pixels)


@contextlib.contextmanager
def encoder(
    path: Path,
    file_format: str,
    spec: oiio.ImageSpec,
    finish: Callable[[Path], None] | None = None,
) -> Iterator["Encoder"]:
    """An `Encoder` of `path`, which gets its final name when the block ends well.

    "tx" makes a tiled texture with all MIP levels of what is written. `finish` is shown the file
    when all rows are in it, before it gets that name.
    """
    check_name(path)
    with replacing(path) as temporary:
        if file_format == "jpeg":
            with _memory(path, spec) as (name, descriptor):
                with Encoder(path, name or str(temporary), file_format, spec) as sink:
                    yield sink
                if descriptor is not None:
                    with open(descriptor, "rb", closefd=False) as held, open(temporary, "wb") as f:
                        held.seek(0)
                        shutil.copyfileobj(held, f, 1 << 20)
        elif file_format == "tx":
            with MipEncoder(path, str(temporary), spec) as sink:
                yield sink
        else:
            with Encoder(path, str(temporary), file_format, spec) as sink:
                yield sink
        if finish is not None:
            finish(temporary)
        _check_whole(path, temporary, file_format)


class Encoder:
    """An image file in the making; `write` takes its rows from top to bottom."""

    def __init__(self, path: Path, name: str, file_format: str, spec: oiio.ImageSpec) -> None:
        """Opens `name`; complaints name `path`."""
        self._path, self._name, self._spec, self._row = path, name, spec, 0
        self._waiting: list[Pixels] = []  # rows that do not fill a row of tiles yet
        sink = oiio.ImageOutput.create(file_format)
        if sink is None:
            raise _failed(path, pending_error())
        # Writing after a failed open ends the process.
        if not sink.open(name, spec):
            raise self._failed(pending_error(sink))
        self._sink = sink

    def __enter__(self) -> "Encoder":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._abandon()
            return
        self._flush(last=True)
        good = self._sink.close()
        error = pending_error(self._sink)
        # PNG returns True on a full disk and tells only here.
        if not good or set(error.splitlines()) - _HARMLESS:
            raise self._failed(error)
        if self._row != self._spec.height:
            raise self._failed(f"{self._row} of {self._spec.height} rows came")

    def _failed(self, error: str) -> Exception:
        """The failure, of the file by its final name."""
        final = error.replace(self._name, str(self._path))
        return _failed(self._path, final.replace(Path(self._name).name, self._path.name))

    def _abandon(self) -> None:
        """Closes a file that nobody will see. PNG complains on the terminal unless it is whole."""
        spec = self._spec
        blank = np.zeros((64, spec.width, spec.nchannels), np.uint8)
        good = self._sink.format_name() == "png"
        while good and self._row < spec.height:
            count = min(len(blank), spec.height - self._row)
            top = spec.y + self._row
            good = self._sink.write_scanlines(top, top + count, spec.z, blank[:count])
            self._row += count
        self._sink.close()
        pending_error(self._sink)

    def write(self, pixels: Pixels) -> None:
        """The next rows (h, W, C)."""
        if not self._spec.tile_height:
            self._put(pixels)
            return
        self._waiting.append(pixels)
        if sum(len(part) for part in self._waiting) >= self._spec.tile_height:
            self._flush()

    def _flush(self, last: bool = False) -> None:
        if not self._waiting:
            return
        rows = np.concatenate(self._waiting) if len(self._waiting) > 1 else self._waiting[0]
        whole = len(rows) if last else len(rows) - len(rows) % self._spec.tile_height
        self._waiting = [rows[whole:]] if whole < len(rows) else []
        if whole:
            self._put(rows[:whole])

    def _put(self, pixels: Pixels) -> None:
        spec, pixels = self._spec, np.ascontiguousarray(pixels)
        top, bottom = spec.y + self._row, spec.y + self._row + len(pixels)
        if spec.tile_height:
            good = self._sink.write_tiles(
                spec.x, spec.x + spec.width, top, bottom, spec.z, spec.z + 1, pixels
            )
        else:
            good = self._sink.write_scanlines(top, bottom, spec.z, pixels)
        if not good:
            raise self._failed(pending_error(self._sink))
        self._row += len(pixels)


class MipEncoder(Encoder):
    """A TIFF of tiles with all MIP levels in the making, as renderers look textures up."""

    def __init__(self, path: Path, name: str, spec: oiio.ImageSpec) -> None:
        spec = spec.copy()
        spec.tile_width, spec.tile_height, spec.tile_depth = TILE, TILE, 1
        spec.attribute("textureformat", "Plain Texture")
        spec.attribute("wrapmodes", "black,black")
        if spec.image_bytes() > _BIG:
            spec.attribute("tiff:bigtiff", 1)
        shape, dtype = (spec.height, spec.width, spec.nchannels), _DTYPES[str(spec.format)]
        self._pyramid = Pyramid(shape, np.dtype(dtype), path.parent)
        try:
            super().__init__(path, name, "tiff", spec)
        except BaseException:
            self._pyramid.close()
            raise

    def write(self, pixels: Pixels) -> None:
        """The next rows (h, W, C)."""
        super().write(pixels)
        try:
            self._pyramid.push(pixels)
        except OSError as error:
            raise self._failed(reason(error)) from error

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        try:
            if kind is None and self._row + sum(map(len, self._waiting)) == self._spec.height:
                self._append_levels()
            super().__exit__(kind, *rest)
        finally:
            self._pyramid.close()

    def _append_levels(self) -> None:
        for shape, rows in self._pyramid.levels():
            self._flush(last=True)
            spec = self._spec.copy()
            spec.height, spec.width, _ = shape
            spec.full_x = spec.full_y = spec.x = spec.y = 0
            spec.full_height, spec.full_width = spec.height, spec.width
            if not self._sink.open(self._name, spec, "AppendSubimage"):
                raise self._failed(pending_error(self._sink))
            self._spec, self._row = spec, 0
            for band in rows:
                super().write(band)


def _check_whole(path: Path, temporary: Path, file_format: str) -> None:
    """Some say nothing when the last bytes find no room: look whether they are there."""
    if file_format == "png":
        try:
            with temporary.open("rb") as file:
                check_png(temporary, file, inflate=False)
        except CutisError as cause:
            raise _failed(path, "the file came out incomplete") from cause
    elif file_format in ("openexr", "dpx"):
        source = oiio.ImageInput.open(str(temporary))
        whole = source is not None
        if source is not None:
            spec = source.spec()
            last = spec.y + spec.height
            if spec.tile_height:
                last_row = (spec.height - 1) // spec.tile_height * spec.tile_height
                tiles = source.read_tiles(
                    spec.x, spec.x + spec.width, spec.y + last_row, last, spec.z, spec.z + 1,
                    0, 1, spec.format,
                )  # fmt: skip
                whole = tiles is not None
            else:
                whole = source.read_scanlines(last - 1, last, 0, 0, 1, spec.format) is not None
        if pending_error(source) or not whole:
            raise _failed(path, "the file came out incomplete")


@contextlib.contextmanager
def _memory(path: Path, spec: oiio.ImageSpec) -> Iterator[tuple[str | None, int | None]]:
    """Where a JPEG is written first: a file in memory, as a name and a descriptor, on Linux.

    On a full disk libjpeg ends the process (it calls exit), so it must not see one. Elsewhere
    (None, None), after a look at the room there is.
    """
    need = int(spec.image_bytes() * 1.5) + (1 << 16)
    in_memory = hasattr(os, "memfd_create")
    limits = [] if in_memory else [shutil.disk_usage(path.resolve().parent).free]
    with contextlib.suppress(ImportError):
        import resource

        limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
        limits += [limit] if limit != resource.RLIM_INFINITY else []
    if any(limit < need for limit in limits):
        raise _failed(path, f"no room for the {need} bytes it may take")
    if not in_memory:
        yield None, None
        return
    descriptor = os.memfd_create("cutis")
    try:
        yield f"/proc/self/fd/{descriptor}", descriptor
    finally:
        os.close(descriptor)


def _failed(path: Path, error: str) -> Exception:
    first = next((line.strip() for line in error.splitlines() if line.strip()), "")
    detail = f" ({first})" if first else ""
    return problem(path, f"cannot be written{detail}; check the folder's rights and free space")
