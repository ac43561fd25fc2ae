"""Named channels in OpenEXR files.

OpenEXR sorts channels by name, so that a column number means nothing: names do.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np
import OpenImageIO as oiio
from numpy.typing import ArrayLike, NDArray

from cutis.textures.decoding import decode
from cutis.textures.encoding import encode
from cutis.textures.problem import problem

Metadata = dict[str, str | float | int]
_INT = range(-(2**31), 2**31)
# Attributes of the file rather than of its maker.
_HOUSEKEEPING = ("oiio:", "openexr:", "screenwindow")
_HOUSEKEEPING_NAMES = {"compression", "datetime", "pixelaspectratio", "name"}


def write_channels(
    path: str | os.PathLike[str],
    channels: Mapping[str, ArrayLike],
    dtype: Literal["float", "half"] = "float",
    metadata: Mapping[str, str | float | int] | None = None,
) -> None:
    """Write arrays (H, W), by name, as channels of one OpenEXR file (scanlines, ZIP).

    `metadata` goes to the header: text, integers of 32 bits, and numbers, which OpenEXR keeps to
    7 digits; empty text is not kept. Raises CutisError, one line that names the file, for arrays
    of different sizes, values too large for `dtype`, another extension than .exr, a failed write.
    """
    path = Path(path)
    if path.suffix.lower() != ".exr":
        raise problem(path, "named channels need an OpenEXR file; end the name in .exr")
    if dtype not in ("float", "half"):
        raise problem(path, f"channels are stored as float or half, not {dtype}")
    arrays = {name: np.asarray(values) for name, values in channels.items()}
    shapes = {name: array.shape for name, array in arrays.items()}
    if len(set(shapes.values())) != 1 or any(a.ndim != 2 or not a.size for a in arrays.values()):
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items()) or "none"
        raise problem(path, f"channels must be (H, W) arrays of one size, not {listed}")
    height, width = next(iter(shapes.values()))
    pixels = np.empty((height, width, len(arrays)), np.float32 if dtype == "float" else np.float16)
    for column, (name, array) in enumerate(arrays.items()):
        with np.errstate(over="ignore"):
            pixels[..., column] = array
        if np.isinf(pixels[..., column]).any() and not np.isinf(array).any():
            raise problem(path, f"channel {name} has values too large for {dtype}; use float")
    spec = oiio.ImageSpec(width, height, len(arrays), dtype)
    spec.channelnames = tuple(arrays)
    spec.attribute("compression", "zip")
    metadata = metadata or {}
    if len({name.lower() for name in metadata}) < len(metadata):
        raise problem(path, "metadata names must differ by more than upper and lower case")
    for name, value in metadata.items():
        if _is_housekeeping(name):
            raise problem(path, f"metadata cannot be called {name}, OpenEXR uses it; rename it")
        if isinstance(value, int) and int(value) not in _INT:
            raise problem(path, f"metadata {name} = {value} exceeds 32 bits; give it as text")
        spec.attribute(name, int(value) if isinstance(value, int) else value)
    encode(path, "openexr", spec, pixels)


def read_channels(path: str | os.PathLike[str]) -> tuple[dict[str, NDArray[np.float32]], Metadata]:
    """Channels (H, W) by name, as float32, and metadata of an OpenEXR file (its first part).

    Metadata that is neither text (UTF-8) nor a number is left out. Raises CutisError, one line
    that names the file, if it cannot be read or is no OpenEXR file.
    """
    path = Path(path)
    decoded = decode(path)
    if decoded.format != "openexr":
        raise problem(path, f"is a {decoded.format.upper()} file; named channels need OpenEXR")
    channels = {
        name: decoded.pixels[..., column].astype(np.float32, order="C")
        for column, name in enumerate(decoded.spec.channelnames)
    }
    metadata: Metadata = {}
    for attribute in decoded.spec.extra_attribs:
        try:
            value = attribute.value
        except UnicodeDecodeError:
            continue
        if isinstance(value, str | int | float) and not _is_housekeeping(attribute.name):
            # The shortest decimal that is this float32: 0.1 comes back as 0.1.
            short = float(str(np.float32(value))) if isinstance(value, float) else value
            metadata[attribute.name] = short
    return channels, metadata


def _is_housekeeping(name: str) -> bool:
    return name.lower().startswith(_HOUSEKEEPING) or name.lower() in _HOUSEKEEPING_NAMES
