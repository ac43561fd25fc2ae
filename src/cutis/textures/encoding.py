"""The one way out through OpenImageIO: an image under its final name whole, or not at all."""

import contextlib
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.textures.atomic import replacing
from cutis.textures.decoding import pending_error
from cutis.textures.headers import image_format
from cutis.textures.problem import check_name, problem

# libtiff is asked for an empty EXIF block and declines; the image is complete all the same.
_HARMLESS = {"failed TIFFWriteCustomDirectory() of the Exif data"}


def encode(path: Path, file_format: str, spec: oiio.ImageSpec, pixels: NDArray[np.generic]) -> None:
    """Write `pixels` (H, W, C) as `spec` says in "png", "jpeg", "tiff" or "openexr".

    Raises CutisError, one line that names the file, and leaves `path` as it was.
    """
    check_name(path)
    with replacing(path) as temporary:
        if file_format == "jpeg":
            with _memory(path, spec) as (name, descriptor):
                _encode(path, name or str(temporary), file_format, spec, pixels)
                if descriptor is not None:
                    with open(descriptor, "rb", closefd=False) as held, open(temporary, "wb") as f:
                        held.seek(0)
                        shutil.copyfileobj(held, f, 1 << 20)
        else:
            _encode(path, str(temporary), file_format, spec, pixels)
        _check_whole(path, temporary, file_format)


def _encode(
    path: Path, name: str, file_format: str, spec: oiio.ImageSpec, pixels: NDArray[np.generic]
) -> None:
    sink = oiio.ImageOutput.create(file_format)
    if sink is None:
        raise _failed(path, pending_error())
    opened = sink.open(name, spec)  # writing after a failed open ends the process
    good = opened and sink.write_image(np.ascontiguousarray(pixels))
    good = sink.close() and good
    error = pending_error(sink)
    # PNG returns True on a full disk and tells only here.
    if not good or (error and error not in _HARMLESS):
        raise _failed(path, error)


def _check_whole(path: Path, temporary: Path, file_format: str) -> None:
    """PNG and OpenEXR say nothing when the last bytes find no room: look whether they are there."""
    if file_format == "png":
        try:
            image_format(temporary)
        except CutisError as cause:
            raise _failed(path, "the file came out incomplete") from cause
    elif file_format == "openexr":
        source = oiio.ImageInput.open(str(temporary))
        whole = source is not None and source.read_image(source.spec().format) is not None
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
