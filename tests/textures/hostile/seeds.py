"""Whole small files of every format and variant, to be damaged: `seeds(folder)`.

Most are written by OpenImageIO; what it does not write (palettes, CMYK, 1 bit, interlace, PSD,
BigTIFF) is made by hand.
"""

import base64
import itertools
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

SIZE = (24, 36)  # rows, columns
_TYPES = {"float16": "half", "float32": "float", "float64": "double"}
_RNG = np.random.default_rng(7)
# 8 × 8, four channels
_CMYK_JPEG = base64.b85decode(
    "|JeWT01iQ9Z(?NtWB>pF0095n07C!}3k(hn3J?wr4iXU%6BsBO7#0>7F(V}%C^|DeJUKHsH$X^SPC!IgMK?H5ZBbWW"
    "VrOV)K233XaAbH~WoKjmzyK5o00;mG1Va%3O%VWD5dcdO0RO}Q6aWDL000000000000000000L6!~hf!0RR9100000"
    "00000000000RP$m4g^C0O#oQ{O8@{r0CqHDSpV4"
)


def pixels(dtype: str, count: int, size: tuple[int, int] = SIZE) -> np.ndarray:
    """Smooth (H, W, count) values from 0.2 to 0.8, with grain, as stored."""
    y, x = np.mgrid[0 : 1 : size[0] * 1j, 0 : 1 : size[1] * 1j]
    planes = [0.5 + 0.2 * np.sin(3 * x + c) + 0.1 * np.cos(4 * y - c) for c in range(count)]
    values = np.stack(planes, -1) + 0.02 * _RNG.random((*size, count))
    largest = np.iinfo(dtype).max if dtype.startswith(("u", "int")) else 1
    return (values * largest).astype(dtype)


def write(path: Path, values: np.ndarray, names: str = "", tile: int = 0, **attributes) -> Path:
    """An image (H, W, C) as it is; attributes have `__` for a colon."""
    height, width, count = values.shape
    spec = oiio.ImageSpec(width, height, count, _TYPES.get(values.dtype.name, values.dtype.name))
    spec.channelnames = tuple(names.split() or ("Y", "YA", "RGB", "RGBA")[count - 1])
    spec.tile_width = spec.tile_height = tile
    spec.alpha_channel = count - 1 if spec.channelnames[-1] == "A" else -1
    for name, value in attributes.items():
        if name in ("x", "y"):
            setattr(spec, name, value)
        else:
            pair = value if isinstance(value, tuple) else (value,)
            spec.attribute(name.replace("__", ":"), *pair)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec), f"{path}: {out.geterror()}"
    assert out.write_image(np.ascontiguousarray(values)), f"{path}: {out.geterror()}"
    assert out.close()
    out.geterror()
    return path


def all_seeds(folder: Path) -> list[Path]:
    """Pictures, maps, and what is no picture, each in a folder of its kind."""
    from hostile.other_seeds import other_seeds

    return [*seeds(folder / "pictures"), *other_seeds(folder / "others")]


def seeds(folder: Path) -> list[Path]:
    """Writes all seed files of pictures and maps into `folder`; the same files every time."""
    global _RNG
    _RNG = np.random.default_rng(7)
    folder.mkdir(parents=True, exist_ok=True)
    makers = (_png, _jpeg, _tiff, _openexr, _dpx, _psd, _maps)
    made = list(itertools.chain.from_iterable(maker(folder) for maker in makers))
    oiio.geterror()
    return made


def icc_profile(curves: str = "para") -> bytes:
    """An ICC profile of Display P3, with parametric or tabulated curves."""
    columns = ((0.5151, 0.2412, -0.0011), (0.2920, 0.6922, 0.0419), (0.1571, 0.0666, 0.7841))
    if curves == "para":
        numbers = (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)
        curve = b"para" + bytes(4) + struct.pack(">HH", 3, 0) + _fixed(numbers)
    else:
        table = (np.linspace(0, 1, 64) ** 1.8 * 65535).astype(">u2").tobytes()
        curve = b"curv" + bytes(4) + struct.pack(">I", 64) + table
    tags = {b"desc": b"desc" + bytes(4) + struct.pack(">I", 5) + b"Mine\0" + bytes(79)}
    for name, column in zip((b"r", b"g", b"b"), columns, strict=True):
        tags[name + b"XYZ"] = b"XYZ " + bytes(4) + _fixed(column)
        tags[name + b"TRC"] = curve
    table, blob = struct.pack(">I", len(tags)), b""
    for name, data in tags.items():
        start = 132 + 12 * len(tags) + len(blob)
        table += struct.pack(">4sII", name, start, len(data))
        blob += data.ljust(-(-len(data) // 4) * 4, b"\0")
    head = struct.pack(">I4sI4s4s4s", 132 + len(table) - 4 + len(blob), b"none", 0x02400000,
                       b"mntr", b"RGB ", b"XYZ ")  # fmt: skip
    head += bytes(12) + b"acsp" + bytes(28) + _fixed((0.9642, 1, 0.8249))
    return head.ljust(128, b"\0") + table + blob


def _fixed(numbers) -> bytes:
    return struct.pack(f">{len(numbers)}i", *(round(n * 65536) for n in numbers))


def profile_attribute(profile: bytes) -> tuple[oiio.TypeDesc, np.ndarray]:
    """An ICC profile as OpenImageIO wants it."""
    return oiio.TypeDesc(f"uint8[{len(profile)}]"), np.frombuffer(profile, np.uint8)


def png_chunk(kind: bytes, data: bytes) -> bytes:
    """A chunk of a PNG with its checksum."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, rows: bytes, colour: int = 2, bits: int = 8, **more) -> bytes:
    """A PNG from its header fields and filtered rows, whether or not they make sense.

    `extra` are chunks before the data, `interlace` is 1 for Adam7.
    """
    header = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, more.get("interlace", 0))
    palette = png_chunk(b"PLTE", bytes(range(48))) if colour == 3 else b""
    body = png_chunk(b"IHDR", header) + palette + more.get("extra", b"")
    body += png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def _png(folder: Path) -> Iterator[Path]:
    for dtype, count in itertools.product(("uint8", "uint16"), (1, 2, 3, 4)):
        yield write(folder / f"{dtype}-{count}.png", pixels(dtype, count))
    profile = profile_attribute(icc_profile())
    yield write(folder / "icc.png", pixels("uint8", 3), ICCProfile=profile,
                Software="somebody", Copyright="nobody", XResolution=72.0)  # fmt: skip
    height, width = SIZE
    values = pixels("uint8", 3)
    passes = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
              (0, 1, 1, 2))  # fmt: skip
    rows = b"".join(
        b"\0" + row.tobytes() for x, y, across, down in passes for row in values[y::down, x::across]
    )
    cases = {
        "interlaced": png(width, height, rows, interlace=1),
        "palette": png(width, height, (b"\0" + bytes(width)) * height, colour=3),
        "palette4": png(width, height, (b"\0" + bytes(width // 2)) * height, colour=3, bits=4),
        "bit": png(width, height, (b"\0" + b"\xaa" * 5) * height, colour=0, bits=1),
        "transparent": png(width, height, (b"\1" + bytes(3 * width)) * height,
                           extra=png_chunk(b"tRNS", bytes(6)) + png_chunk(b"gAMA", bytes(4))),
        "one": png(1, 1, b"\0abc"),
    }  # fmt: skip
    for name, content in cases.items():
        path = folder / f"{name}.png"
        path.write_bytes(content)
        yield path


def _jpeg(folder: Path) -> Iterator[Path]:
    colour = pixels("uint8", 3)
    for subsampling in ("4:4:4", "4:2:0"):
        name = f"{subsampling.replace(':', '')}.jpg"
        yield write(folder / name, colour, jpeg__subsampling=subsampling)
    yield write(folder / "progressive.jpg", colour, jpeg__progressive=1)
    yield write(folder / "grey.jpg", pixels("uint8", 1))
    profile = profile_attribute(icc_profile("curv"))
    yield write(folder / "exif.jpg", colour, ICCProfile=profile, Orientation=6, Make="a camera",
                Exif__FNumber=2.8, ImageDescription="skin", IPTC__City="Basel",
                Keywords="skin; face")  # fmt: skip
    cmyk = folder / "cmyk.jpg"
    cmyk.write_bytes(_CMYK_JPEG)
    yield cmyk


def tiff(width: int, height: int, samples: int, bits: int = 8, photometric: int = 2, **more):
    """An uncompressed TIFF in one strip from its tags; more tags as `extra` {tag: (code, values)}.

    `big` makes it a BigTIFF, `data` are the bytes of the strip.
    """
    big = more.get("big", False)
    data = more.get("data")
    data = b"\x40" * (-(-width * samples * bits // 8) * height) if data is None else data
    tags = {
        256: ("I", [width]), 257: ("I", [height]), 258: ("H", [bits] * samples),
        259: ("H", [1]), 262: ("H", [photometric]), 273: ("I", [0]), 277: ("H", [samples]),
        278: ("I", [height]), 279: ("I", [len(data)]), **more.get("extra", {}),
    }  # fmt: skip
    if photometric == 3:
        tags[320] = ("H", [i * 80 for i in range(3 * 2**bits)])
    word, room, first = ("Q", 8, 16) if big else ("I", 4, 8)
    start = first + (8 if big else 2) + (20 if big else 12) * len(tags) + room
    size = {tag: len(v) * struct.calcsize(t) for tag, (t, v) in tags.items()}
    tags[273] = ("I", [start + sum(n for n in size.values() if n > room)])
    entries = blob = b""
    for tag in sorted(tags):
        code, values = tags[tag]
        packed = struct.pack(f"<{len(values)}{code}", *values)
        entries += struct.pack(f"<HH{word}", tag, {"H": 3, "I": 4}[code], len(values))
        if len(packed) > room:
            entries += struct.pack(f"<{word}", start + len(blob))
            blob += packed
        else:
            entries += packed.ljust(room, b"\0")
    head = b"II+\0" + struct.pack("<HHQ", 8, 0, 16) if big else b"II*\0" + struct.pack("<I", 8)
    count = struct.pack("<Q" if big else "<H", len(tags))
    return head + count + entries + bytes(room) + blob + data


def _tiff(folder: Path) -> Iterator[Path]:
    for kind in ("none", "lzw", "zip", "packbits"):
        yield write(folder / f"{kind}.tif", pixels("uint8", 3), compression=kind)
    yield write(folder / "jpeg.tif", pixels("uint8", 3), compression="jpeg", tiff__RowsPerStrip=8)
    for dtype in ("uint16", "float16", "float32", "float64"):
        kind = "none" if dtype == "float16" else "zip"
        yield write(folder / f"{dtype}.tif", pixels(dtype, 3), compression=kind)
    yield write(folder / "predictor.tif", pixels("float32", 4), compression="zip",
                tiff__predictor=3)  # fmt: skip
    yield write(folder / "tiled.tif", pixels("uint8", 4), tile=16, compression="lzw")
    yield write(folder / "planar.tif", pixels("uint16", 3), planarconfig="separate")
    yield write(folder / "planar-tiled.tif", pixels("uint8", 3), tile=16, planarconfig="separate")
    yield write(folder / "ten.tif", pixels("uint16", 3), oiio__BitsPerSample=10)
    yield write(folder / "grey.tif", pixels("uint8", 1))
    yield write(folder / "five.tif", pixels("uint8", 5), names="R G B A mask")
    nan = pixels("float32", 3)
    nan[16:, 16:32] = np.nan
    yield write(folder / "nan.tif", nan, tile=16)
    profile = profile_attribute(icc_profile())
    yield write(folder / "icc.tif", pixels("uint8", 3), ICCProfile=profile, Software="x" * 40,
                Exif__FNumber=2.8, IPTC__City="Basel", Orientation=3)  # fmt: skip
    width, height = SIZE[::-1]
    cases = {
        "palette": tiff(width, height, 1, photometric=3),
        "palette1": tiff(width, height, 1, bits=1, photometric=3),
        "cmyk": tiff(width, height, 4, photometric=5),
        "bit": tiff(width, height, 1, bits=1, photometric=1),
        "lab": tiff(width, height, 3, photometric=8),
        "ycbcr": tiff(width, height, 3, photometric=6, extra={530: ("H", [1, 1])}),
        "big": tiff(width, height, 3, big=True),
        "spare": tiff(width, height, 5, extra={338: ("H", [2, 0])}),
        "eleven": tiff(width, height, 3, bits=11),
    }
    for name, content in cases.items():
        path = folder / f"{name}.tif"
        path.write_bytes(content)
        yield path
    for dtype in ("uint8", "float32"):
        base = write(folder / f"base-{dtype}.tif", pixels(dtype, 3))
        yield base
        yield _texture(base, folder / f"mip-{dtype}.tx", "tiff")
    two = folder / "pages.tif"
    out = oiio.ImageOutput.create(str(two))
    values = pixels("uint8", 3)
    for mode in ("Create", "AppendSubimage"):
        assert out.open(str(two), oiio.ImageSpec(*SIZE[::-1], 3, "uint8"), mode)
        assert out.write_image(values)
    out.close()
    yield two


def _texture(base: Path, path: Path, file_format: str) -> Path:
    how = oiio.ImageSpec()
    how.tile_width = how.tile_height = 16
    how.attribute("maketx:fileformatname", file_format)
    image = oiio.ImageBuf(str(base))
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, image, str(path), how)
    return path


def _openexr(folder: Path) -> Iterator[Path]:
    kinds = ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab")
    for kind in kinds:
        yield write(folder / f"{kind}.exr", pixels("float16", 3), compression=kind)
        yield write(folder / f"{kind}-tiled.exr", pixels("float32", 4), tile=16, compression=kind)
    yield write(folder / "window.exr", pixels("float16", 3), x=-7, y=5, compression="zip")
    yield write(folder / "grey.exr", pixels("float16", 1))
    yield write(folder / "layers.exr", pixels("float16", 7), names="a.R a.G a.B b.R b.G b.B Z")
    yield write(folder / "numbers.exr", pixels("uint32", 3))
    yield write(folder / "chroma.exr", pixels("float16", 3), colorInteropID="lin_rec709_scene",
                chromaticities=(oiio.TypeDesc("float[8]"),
                                (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)),
                owner="somebody", comments="skin")  # fmt: skip
    nan = pixels("float32", 3)
    nan[16:, 16:32] = np.nan
    yield write(folder / "nan.exr", nan, tile=16, compression="none")
    base = write(folder / "base.exr", pixels("float16", 3))
    yield base
    yield _texture(base, folder / "mip.exr", "openexr")
    yield _deep(folder / "deep.exr", 0)
    yield _deep(folder / "deep-tiled.exr", 16)
    parts = folder / "parts.exr"
    specs = []
    for name, count in (("beauty", 3), ("depth", 1)):
        spec = oiio.ImageSpec(*SIZE[::-1], count, "half")
        spec.channelnames = tuple("RGB") if count == 3 else ("Z",)
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    out = oiio.ImageOutput.create(str(parts))
    assert out.open(str(parts), tuple(specs))
    assert out.write_image(pixels("float16", 3))
    assert out.open(str(parts), specs[1], "AppendSubimage")
    assert out.write_image(pixels("float16", 1))
    out.close()
    yield parts


def _deep(path: Path, tile: int) -> Path:
    spec = oiio.ImageSpec(*SIZE[::-1], 4, "half")
    spec.channelnames = tuple("RGBA")
    spec.deep = True
    spec.tile_width = spec.tile_height = tile
    samples = oiio.DeepData()
    samples.init(spec)
    for texel in range(0, SIZE[0] * SIZE[1], 3):
        samples.set_samples(texel, 1)
        samples.set_deep_value(texel, 0, 0, 0.5)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    assert out.write_deep_image(samples), out.geterror()
    assert out.close()
    return path


def _dpx(folder: Path) -> Iterator[Path]:
    yield write(folder / "8.dpx", pixels("uint8", 3))
    yield write(folder / "alpha.dpx", pixels("uint8", 4))
    for bits in (10, 12, 16):
        yield write(folder / f"{bits}.dpx", pixels("uint16", 3), oiio__BitsPerSample=bits)
    for packing in ("Packed", "Filled, method A", "Filled, method B"):
        name = f"10-{packing.replace(', method ', '-')}.dpx".lower()
        yield write(folder / name, pixels("uint16", 3), oiio__BitsPerSample=10,
                    dpx__Packing=packing)  # fmt: skip
    yield write(folder / "little.dpx", pixels("uint16", 3), oiio__Endian="little")
    yield write(folder / "log.dpx", pixels("uint16", 3), oiio__BitsPerSample=10,
                dpx__Transfer="Printing density")  # fmt: skip
    yield write(folder / "float.dpx", pixels("float32", 3))
    yield write(folder / "grey.dpx", pixels("uint8", 1))


def psd(
    size: tuple[int, int],
    count: int = 3,
    bits: int = 8,
    mode: int = 3,
    packed: bool = False,
    **more,
) -> bytes:
    """A PSD of (rows, columns) from its header fields; `layers` puts one layer in."""
    height, width = size
    rng = np.random.default_rng(3)
    row = -(-width * bits // 8)
    planes = rng.integers(0, 256, (count * height, row)).astype(np.uint8)
    if bits == 32:
        planes = rng.random((count * height, width)).astype(">f4").view(np.uint8)
    if packed:  # each row as runs of at most 128 literal bytes
        rows = [
            b"".join(
                bytes([len(part) - 1]) + part.tobytes()
                for part in (plane[i : i + 128] for i in range(0, row, 128))
            )
            for plane in planes
        ]
        data = struct.pack(f">H{len(rows)}H", 1, *map(len, rows)) + b"".join(rows)
    else:
        data = struct.pack(">H", 0) + planes.tobytes()
    colours = bytes(768) if mode == 2 else b""
    profile = icc_profile() if more.get("profile") else b""
    resources = b"".join(
        b"8BIM" + struct.pack(">HHI", number, 0, len(content)) + content + bytes(len(content) % 2)
        for number, content in ((1005, struct.pack(">IHHIHH", 72 << 16, 1, 1, 72 << 16, 1, 1)),
                                (1039, profile), (1060, b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>"))
        if content
    )  # fmt: skip
    layers = b""
    if more.get("layers"):
        record = struct.pack(">4iH", 0, 0, 4, 5, 3)
        texels = bytes(4 * 5 * bits // 8)
        record += b"".join(struct.pack(">HI", c, 2 + len(texels)) for c in range(3))
        name = b"\x04skin\0\0\0"
        record += b"8BIMnorm" + bytes([255, 0, 0, 0]) + struct.pack(">I", 8 + len(name))
        record += bytes(8) + name
        body = struct.pack(">h", 1) + record + (b"\0\0" + texels) * 3
        body += bytes(len(body) % 2)
        layers = struct.pack(">I", len(body)) + body + bytes(4)
    head = b"8BPS" + struct.pack(">H6xHIIHH", 1, count, height, width, bits, mode)
    sections = (colours, resources, layers)
    return head + b"".join(struct.pack(">I", len(s)) + s for s in sections) + data


def _psd(folder: Path) -> Iterator[Path]:
    cases = {
        "8": psd(SIZE),
        "16": psd(SIZE, bits=16),
        "32": psd(SIZE, bits=32),
        "alpha": psd(SIZE, 4),
        "packed": psd(SIZE, packed=True),
        "packed16": psd(SIZE, 4, bits=16, packed=True, layers=True),
        "layers": psd(SIZE, layers=True, profile=True),
        "cmyk": psd(SIZE, 4, mode=4),
        "grey": psd(SIZE, 1, mode=1),
        "indexed": psd(SIZE, 1, mode=2),
        "bit": psd(SIZE, 1, bits=1, mode=0),
        "lab": psd(SIZE, 3, mode=9),
    }
    for name, content in cases.items():
        path = folder / f"{name}.psd"
        path.write_bytes(content)
        yield path


def _maps(folder: Path) -> Iterator[Path]:

    from cutis.inverse.calibration import Calibration
    from cutis.maps import save_maps, skin_of
    from cutis.optics import PARAMETERS

    y = np.linspace(0, 1, SIZE[0], dtype=np.float32)[:, None]
    values = {
        p.name: np.broadcast_to(np.float32(p.low + (p.high - p.low) * 0.8) * y + p.low * (1 - y),
                                SIZE).astype(np.float32)
        for p in PARAMETERS
    }  # fmt: skip
    skin = skin_of(
        values, model="aliaga2022-exact", calibration=Calibration((1.1, 1.0, 0.9), "white", "A"),
        provenance={"source": "face.png", "source_sha256": "0" * 64, "source_colorspace": "auto"},
    )  # fmt: skip
    for name, kind in (("plain", "float"), ("half", "half")):
        save_maps(skin, folder / f"{name}.skin.exr", kind)
        yield folder / f"{name}.skin.exr"
    save_maps(skin.multiply(melanin=0.5), folder / "edited.skin.exr")
    yield folder / "edited.skin.exr"
