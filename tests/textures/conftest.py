"""Image files made by OpenImageIO, and by hand where it would not make them."""

import runpy
import struct
import sys
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import OpenImageIO as oiio
import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for the package `hostile`

NAMES = {1: ["Y"], 2: ["Y", "A"], 3: ["R", "G", "B"], 4: ["R", "G", "B", "A"]}
TYPES = {"float16": "half", "float32": "float", "float64": "double"}


def write_image(path, pixels, names=None, attributes=None, formats=None, tile=0):
    """Write (H, W, C) as it is; `attributes` {name: value or (type, value)}."""
    height, width, count = pixels.shape
    kind = TYPES.get(pixels.dtype.name, pixels.dtype.name)
    spec = oiio.ImageSpec(width, height, count, kind)
    spec.channelnames = names or NAMES[count]
    spec.tile_width = spec.tile_height = tile
    if formats:
        spec.channelformats = formats
    if "A" in spec.channelnames:
        spec.alpha_channel = spec.channelnames.index("A")
    for name, value in (attributes or {}).items():
        spec.attribute(name, *(value if isinstance(value, tuple) else (value,)))
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec), out.geterror()
    assert out.write_image(np.ascontiguousarray(pixels))
    assert out.close()
    out.geterror()
    return path


def read_image(path):
    """Stored values and header, by OpenImageIO alone."""
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), hints)
    assert source is not None, oiio.geterror()
    spec = source.spec().copy()
    pixels = source.read_image(0, 0, 0, spec.nchannels, spec.format)
    assert pixels is not None, source.geterror()
    assert not source.geterror()
    source.close()
    return pixels, spec


def write_png(path, width, height, colour=2, rows=None, extra=b""):
    """An 8 bit PNG from its header fields, without asking whether they make sense."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    data = zlib.compress(b"\0" * 100 if rows is None else rows)
    header = struct.pack(">IIBBBBB", width, height, 8, colour, 0, 0, 0)
    palette = chunk(b"PLTE", bytes(range(12))) if colour == 3 else b""
    body = chunk(b"IHDR", header) + palette + extra + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + body)
    return path


def write_tiff(path, width, height, samples, bits=8, photometric=2, **more):
    """An uncompressed TIFF from its tags: `extra` samples, `kind` 1 unsigned, 2 signed, 3 float."""
    data = more["data"] if "data" in more else b"\x40" * (width * height * samples * bits // 8)
    tags = {
        256: ("I", [width]),
        257: ("I", [height]),
        258: ("H", [bits] * samples),
        259: ("H", [1]),
        262: ("H", [photometric]),
        273: ("I", [0]),
        277: ("H", [samples]),
        278: ("I", [height]),
        279: ("I", [len(data)]),
        339: ("H", [more.get("kind", 1)] * samples),
    }
    if "extra" in more:
        tags[338] = ("H", more["extra"])
    if photometric == 3:
        tags[320] = ("H", [i * 80 for i in range(768)])
    size = {name: len(v) * struct.calcsize(t) for name, (t, v) in tags.items()}
    start = 8 + 2 + 12 * len(tags) + 4
    tags[273] = ("I", [start + sum(n for n in size.values() if n > 4)])
    entries = blob = b""
    for name in sorted(tags):
        code, values = tags[name]
        packed = struct.pack(f"<{len(values)}{code}", *values)
        entries += struct.pack("<HHI", name, {"H": 3, "I": 4}[code], len(values))
        if len(packed) > 4:
            entries += struct.pack("<I", start + len(blob))
            blob += packed
        else:
            entries += packed.ljust(4, b"\0")
    header = b"II*\0" + struct.pack("<IH", 8, len(tags))
    Path(path).write_bytes(header + entries + bytes(4) + blob + data)
    return path


def write_psd(path, pixels, mode=3, layer=b"", resources=b""):
    """A PSD of nothing but the merged picture (H, W, C); with a `layer` its fourth is alpha."""
    height, width, count = pixels.shape
    depth = 8 * pixels.dtype.itemsize
    kind = {8: ">u1", 16: ">u2", 32: ">f4"}[depth]
    header = b"8BPS" + struct.pack(">H6xHIIHH", 1, count, height, width, depth, mode)
    if layer:
        layer = layer.ljust(-(-len(layer) // 2) * 2, b"\0")
        layer = struct.pack(">I", len(layer)) + layer + bytes(4)
    parts = (b"", resources, layer)
    body = b"".join(struct.pack(">I", len(part)) + part for part in parts)
    Path(path).write_bytes(
        header + body + b"\0\0" + np.moveaxis(pixels, -1, 0).astype(kind).tobytes()
    )
    return path


def psd_block(number, data):
    """An image resource of a PSD."""
    return b"8BIM" + struct.pack(">HHI", number, 0, len(data)) + data + bytes(len(data) % 2)


def psd_layer():
    """One empty layer; their number is negative, which says that the merged picture has alpha."""
    channels = b"".join(struct.pack(">hI", channel, 2) for channel in (0, 1, 2, -1))
    record = bytes(16) + struct.pack(">H", 4) + channels + b"8BIMnorm" + bytes([255, 0, 8, 0])
    extra = bytes(8) + b"\3top"
    return struct.pack(">h", -1) + record + struct.pack(">I", len(extra)) + extra + bytes(8)


@pytest.fixture(scope="session")
def make():
    """The writers, and the reader to check with."""

    class Make:
        image = staticmethod(write_image)
        read = staticmethod(read_image)
        png = staticmethod(write_png)
        tiff = staticmethod(write_tiff)
        psd = staticmethod(write_psd)
        psd_block = staticmethod(psd_block)
        psd_layer = staticmethod(psd_layer)

    return Make


@pytest.fixture
def random():
    return np.random.default_rng(20)


@pytest.fixture(scope="session")
def one_line():
    """Check that an error is one line that names the file."""

    def check(caught, path):
        message = str(caught.value)
        assert len(message.splitlines()) == 1
        assert str(path) in message
        return message

    return check


@pytest.fixture(scope="session")
def icc():
    """What profiles.py holds: ICC profiles from their tags."""
    return SimpleNamespace(**runpy.run_path(str(Path(__file__).with_name("profiles.py"))))


@pytest.fixture(scope="session")
def measured_rgb(shared_data):
    """(n, 3) linear sRGB of measured skins, float32."""
    from cutis.colour import reflectance_to_rgb
    from studies.figures.measured import BANDS, measured_skins

    return reflectance_to_rgb(measured_skins(shared_data), BANDS).astype(np.float32)
