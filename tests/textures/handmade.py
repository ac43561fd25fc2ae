"""Image files byte by byte, for what no program of ours writes: a header may state anything."""

import struct
import zlib

import numpy as np

SIZE = (6, 8)  # rows, columns


def texels(kind="uint8", size=SIZE):
    """(H, W, 3) no two of which are alike, lighter to the right and below."""
    height, width = size
    y, x = np.mgrid[0:height, 0:width]
    value = np.stack([0.3 + 0.04 * x, 0.2 + 0.04 * y, 0.15 + 0.01 * (x + 2 * y)], -1)
    if kind.startswith("uint"):
        return np.rint(value * np.iinfo(kind).max).astype(kind)
    return value.astype(kind)


def png_chunk(kind, data):
    checksum = zlib.crc32(kind + data)
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", checksum)


def png(path, *chunks, pixels=None):
    """An RGB PNG of 8 or 16 bit with further chunks (name, data) before its pixels."""
    pixels = texels() if pixels is None else pixels
    height, width = pixels.shape[:2]
    bits = 8 * pixels.dtype.itemsize
    rows = b"".join(b"\0" + row.astype(row.dtype.newbyteorder(">")).tobytes() for row in pixels)
    header = struct.pack(">IIBBBBB", width, height, bits, 2, 0, 0, 0)
    parts = [(b"IHDR", header), *chunks, (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(png_chunk(*part) for part in parts))
    return path


def ifd(tags, start, order="<"):
    """A directory (tag: (struct letter or "s", values)) at `start`, with its values behind it.

    A value that is a dictionary becomes a directory of its own, which its tag points to.
    """
    types = {"B": 1, "s": 2, "H": 3, "I": 4, "R": 5, "U": 7}
    entries, blob = b"", b""
    room = start + 2 + 12 * len(tags) + 4
    for tag in sorted(tags):
        value = tags[tag]
        if isinstance(value, dict):
            inner = ifd(value, room + len(blob), order)
            entries += struct.pack(f"{order}HHII", tag, 4, 1, room + len(blob))
            blob += inner + bytes(len(inner) % 2)
            continue
        code, values = value
        if code in ("s", "U"):
            packed, count = values, len(values)
        elif code == "R":
            pairs = [n for v in values for n in (round(v * 100000), 100000)]
            packed, count = struct.pack(f"{order}{len(pairs)}I", *pairs), len(values)
        else:
            packed, count = struct.pack(f"{order}{len(values)}{code}", *values), len(values)
        entries += struct.pack(f"{order}HHI", tag, types[code], count)
        if len(packed) > 4:
            entries += struct.pack(f"{order}I", room + len(blob))
            blob += packed + bytes(len(packed) % 2)
        else:
            entries += packed.ljust(4, b"\0")
    return struct.pack(f"{order}H", len(tags)) + entries + bytes(4) + blob


def exif(tags, order="<"):
    """An Exif block, as PNG holds it; JPEG wants b"Exif\\0\\0" in front."""
    head = {"<": b"II*\0\x08\0\0\0", ">": b"MM\0*\0\0\0\x08"}[order]
    return head + ifd(tags, 8, order)


def jpeg(path, *segments, pixels=None):
    """A JPEG of Pillow's with further segments (marker, data) in front."""
    import io

    from PIL import Image

    held = io.BytesIO()
    pixels = texels() if pixels is None else pixels
    Image.fromarray(pixels).save(held, "JPEG", quality=100, subsampling=0)
    more = b"".join(b"\xff" + bytes([m]) + struct.pack(">H", 2 + len(d)) + d for m, d in segments)
    path.write_bytes(held.getvalue()[:2] + more + held.getvalue()[2:])
    return path


def jpeg_exif(tags, order="<"):
    """The segment of an Exif block."""
    return 0xE1, b"Exif\0\0" + exif(tags, order)


def tiff(path, tags=None, pixels=None, more=(), order="<"):
    """An uncompressed TIFF of RGB pages: (tags, pixels) and those of `more`, in one strip each."""
    content = {"<": b"II*\0", ">": b"MM\0*"}[order] + struct.pack(f"{order}I", 8)
    pages = [(tags or {}, texels() if pixels is None else pixels), *more]
    for number, (own, values) in enumerate(pages):
        height, width, count = values.shape
        data = values.astype(values.dtype.newbyteorder(order)).tobytes()
        kind = {"u": 1, "i": 2, "f": 3}[values.dtype.kind]
        known = {
            256: ("I", [width]), 257: ("I", [height]),
            258: ("H", [8 * values.dtype.itemsize] * count), 259: ("H", [1]),
            262: ("H", [2 if count > 2 else 1]), 273: ("I", [0]), 277: ("H", [count]),
            278: ("I", [height]), 279: ("I", [len(data)]), 339: ("H", [kind] * count),
        } | own  # fmt: skip
        start = len(content)
        size = len(ifd(known, start, order))
        known[273] = ("I", [start + size])
        directory = bytearray(ifd(known, start, order))
        if number + 1 < len(pages):
            after = start + size + len(data) + len(data) % 2
            at = 2 + 12 * len(known)
            directory[at : at + 4] = struct.pack(f"{order}I", after)
        content += bytes(directory) + data + bytes(len(data) % 2)
    path.write_bytes(content)
    return path


def attribute(name, kind, value):
    """An attribute of an OpenEXR header."""
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def exr_text(name, text):
    """One that is text."""
    return attribute(name, "string", text if isinstance(text, bytes) else text.encode())


def exr_numbers(name, kind, *numbers):
    """One of floats, or of whole numbers for "int"."""
    return attribute(name, kind, struct.pack(f"<{len(numbers)}{'i' if kind == 'int' else 'f'}",
                                             *numbers))  # fmt: skip


def exr(path, *attributes, pixels=None, names="RGB", data=(0, 0), display=None):
    """An uncompressed OpenEXR of floats.

    `data` is the corner (x, y) of its data window, `display` (x, y, width, height) another display
    window.
    """
    pixels = texels("float32") if pixels is None else pixels
    height, width = pixels.shape[:2]
    x, y = data
    left, top, across, down = display or (x, y, width, height)
    order = sorted(range(len(names)), key=lambda i: names[i])
    channels = b"".join(names[i].encode() + b"\0" + struct.pack("<IIII", 2, 0, 1, 1) for i in order)
    header = b"v/1\x01" + struct.pack("<I", 2)
    header += attribute("channels", "chlist", channels + b"\0")
    header += attribute("compression", "compression", b"\0")
    window = struct.pack("<4i", x, y, x + width - 1, y + height - 1)
    header += attribute("dataWindow", "box2i", window)
    window = struct.pack("<4i", left, top, left + across - 1, top + down - 1)
    header += attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += exr_numbers("pixelAspectRatio", "float", 1.0)
    header += exr_numbers("screenWindowCenter", "v2f", 0.0, 0.0)
    header += exr_numbers("screenWindowWidth", "float", 1.0)
    header += b"".join(attributes) + b"\0"
    lines = [
        struct.pack("<iI", y + row, 4 * width * len(names))
        + b"".join(pixels[row, :, i].astype("<f4").tobytes() for i in order)
        for row in range(height)
    ]
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + row * len(lines[0]) for row in range(height)))
    path.write_bytes(header + offsets + b"".join(lines))
    return path
