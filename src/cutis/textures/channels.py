"""Named channels in OpenEXR files.

OpenEXR sorts channels by name, so that a column number means nothing: names do.
"""

import contextlib
import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
import OpenImageIO as oiio
from numpy.typing import ArrayLike, NDArray

from cutis.textures.closing import Closing
from cutis.textures.decoding import Decoder
from cutis.textures.encoding import encoder
from cutis.textures.frame import Frame, whole_frame
from cutis.textures.problem import problem
from cutis.textures.specs import ZIP
from cutis.textures.texture import bands

_TOGETHER = 8  # rows that are put together at a time, so that they stay in the processor's cache
Metadata = dict[str, str | float | int]
Value = str | float | int | tuple[float, ...]
_HEADER = 64 << 20  # bytes of a file among which its header is
_INT = range(-(2**31), 2**31)
# Attributes of the file rather than of its maker.
_HOUSEKEEPING = ("oiio:", "openexr:", "screenwindow")
_HOUSEKEEPING_NAMES = {"compression", "datetime", "pixelaspectratio", "name"}


def write_channels(
    path: str | os.PathLike[str],
    channels: Mapping[str, ArrayLike],
    dtype: Literal["float", "half"] = "float",
    metadata: Mapping[str, Value] | None = None,
) -> None:
    """Write arrays (H, W), by name, as channels of one OpenEXR file (scanlines, ZIP).

    `metadata` goes to the header: text, integers of 32 bits, numbers, which OpenEXR keeps to
    7 digits, and tuples of eight numbers; empty text is not kept. Raises CutisError, one line that
    names the file, for arrays of different sizes, values too large for `dtype`, another extension
    than .exr, a failed write.
    """
    arrays = {name: np.asarray(values) for name, values in channels.items()}
    shapes = {name: array.shape for name, array in arrays.items()}
    if len(set(shapes.values())) != 1 or any(a.ndim != 2 or not a.size for a in arrays.values()):
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items()) or "none"
        raise problem(path, f"channels must be (H, W) arrays of one size, not {listed}")
    shape = next(iter(shapes.values()))
    with channel_writer(path, tuple(arrays), shape, dtype, metadata) as write:
        for rows in bands(shape):
            write({name: array[rows] for name, array in arrays.items()})


@contextlib.contextmanager
def channel_writer(
    path: str | os.PathLike[str],
    names: Sequence[str],
    shape: tuple[int, int],
    dtype: Literal["float", "half"] = "float",
    metadata: Mapping[str, Value] | None = None,
    half: Collection[str] = (),
    frame: Frame | None = None,
    late: Mapping[str, Callable[[], str]] | None = None,
) -> Iterator[Callable[[Mapping[str, NDArray[np.generic]]], None]]:
    """What `write_channels` does, some rows at a time.

    Yields a function that takes the next rows, top to bottom: arrays (h, W) by name. `half` names
    channels that are stored as half whatever `dtype` says, `frame` where the texels lie on their
    picture: it becomes the windows. `late` are texts for the header that are known only when all
    rows have come: each is called at the start and at the end, and gives as many bytes of ASCII.
    """
    path, (height, width) = Path(path), shape
    if path.suffix.lower() != ".exr":
        raise problem(path, "named channels need an OpenEXR file; end the name in .exr")
    if dtype not in ("float", "half"):
        raise problem(path, f"channels are stored as float or half, not {dtype}")
    spec = oiio.ImageSpec(width, height, len(names), dtype)
    spec.channelnames = tuple(names)
    if dtype == "float" and half:
        spec.channelformats = tuple(
            oiio.TypeHalf if name in half else oiio.TypeFloat for name in names
        )
    (whole_frame(shape) if frame is None else frame).to(spec)
    spec.attribute("compression", ZIP)
    metadata = metadata or {}
    if len({name.lower() for name in metadata}) < len(metadata):
        raise problem(path, "metadata names must differ by more than upper and lower case")
    for name, value in metadata.items():
        if _is_housekeeping(name):
            raise problem(path, f"metadata cannot be called {name}, OpenEXR uses it; rename it")
        if isinstance(value, tuple):
            spec.attribute(name, oiio.TypeDesc(f"float[{len(value)}]"), value)
            continue
        if isinstance(value, int) and int(value) not in _INT:
            raise problem(path, f"metadata {name} = {value} exceeds 32 bits; give it as text")
        spec.attribute(name, int(value) if isinstance(value, int) else value)
    kind = np.dtype(np.float32 if dtype == "float" else np.float16)
    first = {name: text() for name, text in (late or {}).items()}
    for name, held in first.items():
        spec.attribute(name, held)

    def finish(temporary: Path) -> None:
        for name, text in (late or {}).items():
            _put_late(temporary, name, first[name], text())

    with encoder(path, "openexr", spec, finish) as sink:

        def write(part: Mapping[str, NDArray[np.generic]]) -> None:
            rows = len(next(iter(part.values())))
            pixels = np.empty((rows, width, len(names)), kind)
            with np.errstate(over="ignore"):
                for top in range(0, rows, _TOGETHER):
                    some = slice(top, top + _TOGETHER)
                    for column, name in enumerate(names):
                        pixels[some, :, column] = part[name][some]
            for column, name in enumerate(names):
                if part[name].dtype.itemsize > kind.itemsize and _overflows(
                    pixels[..., column], part[name]
                ):
                    what = f"channel {name} has values too large for {dtype}; use float"
                    raise problem(path, what)
            sink.write(pixels)

        yield write


def _put_late(path: Path, name: str, held: str, text: str) -> None:
    """Puts a text in place of one of as many bytes in the header of a file, which is not packed."""
    before, after = held.encode("ascii"), text.encode("ascii")
    # OpenEXR: name, NUL, "string", NUL, length in 4 bytes, value
    start = b"\0".join((name.encode("ascii"), b"string", b""))
    mark = start + len(before).to_bytes(4, "little") + before
    with path.open("r+b") as file:
        place = file.read(_HEADER).find(mark)
        if place < 0 or len(before) != len(after):
            raise problem(path, f"its header has no place for {name}; report this")
        file.seek(place + len(mark) - len(before))
        file.write(after)


class ChannelFile(Closing):
    """An open OpenEXR file of named channels (its first part), read some rows at a time.

    `names` are its channels, `frame` says where they lie on their picture, `metadata` what the
    header says, as text or numbers; other metadata is left out. With `shown` its rows are those of
    the picture, 0 where nothing is stored. Raises CutisError, one line that names the file, if it
    cannot be read or is no OpenEXR file. Close it, or use it in a with block.
    """

    def __init__(self, path: str | os.PathLike[str], shown: bool = False) -> None:
        self.path = Path(path)
        self._source = Decoder(self.path, shown=shown)
        kind = self._source.file_format
        if kind != "openexr":
            self.close()
            raise problem(path, f"is a {kind.upper()} file; named channels need OpenEXR")
        self.shape, self.frame = self._source.shape, self._source.frame
        self.names = tuple(self._source.spec.channelnames)
        self.metadata = _metadata(self._source.spec)

    def close(self) -> None:
        """Lets go of the file."""
        self._source.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the file, of about half a million texels each."""
        return bands(self.shape, self._source.step)

    def rows(
        self, rows: slice, wanted: Collection[str] | None = None
    ) -> dict[str, NDArray[np.float32]]:
        """Channels (h, W) by name, float32, of some rows: all, or those that are wanted."""
        pixels = self._source.rows(rows)
        columns = [
            column for column, name in enumerate(self.names) if wanted is None or name in wanted
        ]
        planes = np.empty((len(columns), *pixels.shape[:2]), np.float32)
        for top in range(0, len(pixels), _TOGETHER):
            some = slice(top, top + _TOGETHER)
            part = pixels[some] if wanted is None else pixels[some][..., columns]
            planes[:, some] = np.moveaxis(part, 2, 0)
        return dict(zip([self.names[column] for column in columns], planes, strict=True))


def read_channels(path: str | os.PathLike[str]) -> tuple[dict[str, NDArray[np.float32]], Metadata]:
    """All channels (H, W) by name, and metadata; see `ChannelFile`."""
    with ChannelFile(path) as file:
        return file.rows(slice(None)), file.metadata


def _metadata(spec: oiio.ImageSpec) -> Metadata:
    found: Metadata = {}
    for attribute in spec.extra_attribs:
        try:
            value = attribute.value
        except UnicodeDecodeError:
            continue
        if isinstance(value, str | int | float) and not _is_housekeeping(attribute.name):
            # The shortest decimal that is this float32: 0.1 comes back as 0.1.
            short = float(str(np.float32(value))) if isinstance(value, float) else value
            found[attribute.name] = short
    return found


def _overflows(stored: NDArray[np.generic], values: NDArray[np.generic]) -> bool:
    """Whether values are infinite only since they were stored."""
    return bool(np.isinf(stored).any() and not np.isinf(values).any())


def _is_housekeeping(name: str) -> bool:
    return name.lower().startswith(_HOUSEKEEPING) or name.lower() in _HOUSEKEEPING_NAMES
