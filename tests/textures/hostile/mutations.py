"""Damage to files: `mutate` takes a whole one and gives a broken one, and says how.

Plain damage does not know the format. Damage that does gets further into the decoders: PNG with its
checksums made right again, fields of TIFF directories, values of OpenEXR attributes and offsets.
"""

import re
import struct
import zlib
from collections.abc import Callable
from random import Random

from hostile.seeds import png_chunk

# Sizes, counts and offsets that programs get wrong.
_NUMBERS = (
    *(0, 1, 2, 3, 4, 5, 7, 8, 15, 16, 17, 31, 32, 33, 63, 64, 127, 128, 255, 256, 257, 1000),
    *(4095, 4096, 32767, 32768, 65534, 65535, 65536, 100_000, 2**20, 2**24, 2**28, 2**30),
    *(2**31 - 1, 2**31, 2**31 + 1, 2**32 - 16, 2**32 - 2, 2**32 - 1),
)


def mutate(content: bytes, other: bytes, random: Random) -> tuple[str, bytes]:
    """What was done, and `content` after it; `other` is a file to take pieces from."""
    kinds = list(_PLAIN.items())
    if b"\0" not in content[:2000]:
        kinds += list(_TEXT.items()) * 3
    for magic, own in _OWN.items():
        if content.startswith(magic):
            kinds += list(own.items()) * 3
    name, damage = random.choice(kinds)
    out = damage(content, other, random)
    if out != content:
        return name, out
    return "flip", _flip(content, other, random)


def _flip(content: bytes, other: bytes, random: Random) -> bytes:
    out = bytearray(content)
    for _ in range(random.choice((1, 1, 2, 4, 16))):
        out[_place(len(out), random)] ^= 1 << random.randrange(8)
    return bytes(out)


def _truncate(content: bytes, other: bytes, random: Random) -> bytes:
    return content[: random.randrange(len(content))]


def _run(content: bytes, other: bytes, random: Random) -> bytes:
    start, length = _place(len(content), random), random.choice((1, 2, 4, 8, 32, 128, 1000))
    fill = random.choice((b"\0", b"\xff", b"\x7f", bytes([random.randrange(256)])))
    return content[:start] + (fill * length)[: len(content) - start] + content[start + length :]


def _number(content: bytes, other: bytes, random: Random) -> bytes:
    out = bytearray(content)
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        code = random.choice(("<I", ">I", "<H", ">H", "<Q", "B"))
        size = struct.calcsize(code)
        at = max(0, _place(len(out), random) - size)
        at -= at % random.choice((1, min(2, size), size))
        value = random.choice(_NUMBERS) & (2 ** (8 * size) - 1)
        out[at : at + size] = struct.pack(code, value)
    return bytes(out[: max(len(content), 1)])


def _splice(content: bytes, other: bytes, random: Random) -> bytes:
    cut = _place(len(content), random)
    start = random.choice((cut, _place(len(other), random)))
    return content[:cut] + other[start:]


def _move(content: bytes, other: bytes, random: Random) -> bytes:
    """A piece removed, doubled, or put elsewhere."""
    start, length = _place(len(content), random), random.randrange(1, 200)
    piece, rest = content[start : start + length], content[:start] + content[start + length :]
    how = random.randrange(3)
    if how == 0:
        return rest
    at = _place(len(content), random)
    return (rest if how == 1 else content)[:at] + piece + (rest if how == 1 else content)[at:]


def _place(length: int, random: Random) -> int:
    """A position, in the header as often as in the rest."""
    reach = random.choice((32, 256, 2048, length, length, length))
    return random.randrange(max(1, min(length, reach)))


_PLAIN: dict[str, Callable[[bytes, bytes, Random], bytes]] = {
    "truncate": _truncate,
    "flip": _flip,
    "run": _run,
    "number": _number,
    "splice": _splice,
    "move": _move,
}


# What stands in texts where numbers and words should be.
_WORDS = (
    *b"0 1 -1 1e999 -1e-999 nan inf 9999999999999999999 0x10 1_0 1,5 1.5.5 +-3 99999".split(),
    *(b"", b"=1+1", b"#", b'"', b"'", b"{", b"}", b"[", b"]", b"..", b"/dev/zero", b"../../x"),
    *(b"\0", b"\x1b[2J", b"\xff\xfe", b"\xe2\x80\xae", b"\xed\xb3\xa8", b"\xf0\x9f\x99\x82"),
    *(b"wavelength", b"nm", b"%", b"ENVI", b"BEGIN_DATA", b"sep=;", b"bsq", b"&a *a", b"2147483"),
    *(b"9" * 400, b"A" * 70_000, b"[" * 5000, b"{a: " * 2000, b"-" * 4000),
)  # fmt: skip
_PIECES = re.compile(rb"[\w.+-]+|[^\w\s]")


def _word(content: bytes, other: bytes, random: Random) -> bytes:
    """Words and numbers of a text replaced by others."""
    out = content
    for _ in range(random.choice((1, 1, 2, 5))):
        places = [m.span() for m in _PIECES.finditer(out[:20_000])]
        if not places:
            return out
        start, end = random.choice(places)
        out = out[:start] + random.choice(_WORDS) + out[end:]
    return out


def _line(content: bytes, other: bytes, random: Random) -> bytes:
    """Lines of a text removed, doubled, moved, or taken from another text."""
    lines = content.split(b"\n")
    at, how = random.randrange(len(lines)), random.randrange(6)
    if how == 0:
        lines.pop(at)
    elif how == 1:
        lines[at:at] = [lines[at]] * random.choice((1, 2, 300))
    elif how == 2:
        random.shuffle(lines)
    elif how == 3 and b"\0" not in other[:2000]:
        lines.insert(at, random.choice(other.split(b"\n"))[:5000])
    elif how == 4:
        lines[at] = lines[at] + random.choice(_WORDS)
    else:
        lines = [line.replace(b",", random.choice((b";", b"\t", b" ", b",,"))) for line in lines]
    return random.choice((b"\n", b"\n", b"\n", b"\r", b"\r\n")).join(lines)


_TEXT: dict[str, Callable[[bytes, bytes, Random], bytes]] = {"word": _word, "line": _line}


def _npy_header(content: bytes, other: bytes, random: Random) -> bytes:
    """The header of a NumPy array, its length right."""
    length = struct.unpack("<H", content[8:10])[0]
    header = random.choice((_word, _flip, _truncate))(content[10 : 10 + length], other, random)
    return content[:8] + struct.pack("<H", len(header) % 65536) + header + content[10 + length :]


def _png_chunks(content: bytes) -> list[tuple[bytes, bytes]]:
    at, found = 8, []
    while at + 12 <= len(content):
        length, kind = struct.unpack(">I4s", content[at : at + 8])
        found.append((kind, content[at + 8 : at + 8 + length]))
        at += 12 + length
    return found


def _png_join(chunks: list[tuple[bytes, bytes]]) -> bytes:
    return b"\x89PNG\r\n\x1a\n" + b"".join(png_chunk(kind, data) for kind, data in chunks)


def _png_field(content: bytes, other: bytes, random: Random) -> bytes:
    """One chunk's data damaged, its checksum right."""
    chunks = _png_chunks(content)
    at = random.choice((0, random.randrange(len(chunks))))
    kind, data = chunks[at]
    if data:
        damage = random.choice((_flip, _number, _run, _truncate))
        chunks[at] = kind, damage(data, other, random)
    return _png_join(chunks)


_PNG_CHUNKS = (
    b"PLTE tRNS iCCP tEXt zTXt iTXt eXIf cHRM sRGB gAMA pHYs bKGD IDAT IEND sBIT hIST acTL "
    b"tIME sPLT IHDR CgBI a1!?"
).split()


def _png_order(content: bytes, other: bytes, random: Random) -> bytes:
    """Chunks removed, doubled, in another order, with other names, or taken from another PNG."""
    chunks = _png_chunks(content)
    at, how = random.randrange(len(chunks)), random.randrange(5)
    if how == 0:
        chunks.pop(at)
    elif how == 1:
        chunks.insert(random.randrange(len(chunks)), chunks[at])
    elif how == 2:
        random.shuffle(chunks)
    elif how == 3:
        chunks[at] = random.choice(_PNG_CHUNKS), chunks[at][1]
    elif other.startswith(b"\x89PNG"):
        chunks.insert(random.randrange(1, len(chunks)), random.choice(_png_chunks(other)))
    return _png_join(chunks)


def _png_inside(content: bytes, other: bytes, random: Random) -> bytes:
    """Compressed data (pixels, ICC profile) damaged before it is compressed."""
    chunks = _png_chunks(content)
    packed = [i for i, (kind, _) in enumerate(chunks) if kind in (b"IDAT", b"iCCP")]
    if not packed:
        return content
    at = random.choice(packed)
    kind, data = chunks[at]
    head, stream = b"", data
    if kind == b"iCCP":
        head, stream = data[: data.index(b"\0") + 2], data[data.index(b"\0") + 2 :]
    try:
        plain = zlib.decompress(stream)
    except zlib.error:
        return content
    damage = random.choice((_flip, _number, _run, _truncate, _move))
    chunks[at] = kind, head + zlib.compress(damage(plain, other, random))
    return _png_join(chunks)


def _tiff_entry(content: bytes, other: bytes, random: Random) -> bytes:
    """Tag, type, count or value of entries of the first directory."""
    order = "<" if content[:1] == b"I" else ">"
    big = content[2:4] in (b"+\0", b"\0+")
    start = struct.unpack(order + ("Q" if big else "I"), content[8:16] if big else content[4:8])[0]
    lead, size = (8, 20) if big else (2, 12)
    if start + lead > len(content):
        return content
    (count,) = struct.unpack(order + ("Q" if big else "H"), content[start : start + lead])
    out = bytearray(content)
    for _ in range(random.choice((1, 1, 2, 3))):
        at = start + lead + size * random.randrange(max(1, min(count, 60)))
        what = random.choice(("tag", "type", "count", "value", "value", "value"))
        wide = "Q" if big else "I"
        where, code = {
            "tag": (0, "H"),
            "type": (2, "H"),
            "count": (4, wide),
            "value": (12 if big else 8, random.choice((wide, "H", "I"))),
        }[what]
        tags = (254, 256, 257, 258, 259, 262, 266, 273, 274, 277, 278, 279, 284, 317, 320, 322, 323,
                324, 325, 330, 338, 339, 347, 530, 700, 33723, 34377, 34665, 34675)  # fmt: skip
        value = random.choice((*_NUMBERS, *tags) if what == "tag" else _NUMBERS)
        value &= 2 ** (8 * struct.calcsize(order + code)) - 1
        struct.pack_into(order + code, out, min(at + where, len(out) - 8), value)
    return bytes(out)


def _exr_attribute(content: bytes, other: bytes, random: Random) -> bytes:
    """Size, type or value of attributes, and offsets of chunks."""
    at, values = 8, []
    while at < len(content) and content[at]:
        try:
            name = content.index(b"\0", at)
            kind = content.index(b"\0", name + 1)
        except ValueError:
            break
        size = struct.unpack("<I", content[kind + 1 : kind + 5].ljust(4, b"\0"))[0]
        values.append((kind + 5, size))
        at = kind + 5 + size
    values.append((at + 1, 8 * 40))  # the table of offsets, and the first chunks
    out = bytearray(content)
    for _ in range(random.choice((1, 1, 2))):
        start, size = random.choice(values)
        if random.randrange(6) == 0:
            start, size = start - 4, 4
        place = min(start + random.randrange(max(1, size)), len(out) - 8)
        if random.randrange(2):
            place = max(8, place - (place - start) % 4)
            struct.pack_into("<I", out, place, random.choice(_NUMBERS))
        else:
            out[place] = random.randrange(256)
    return bytes(out)


# What the library looks up, and where others put it: any file may use the names for other things.
_NAMES = (
    b"ICCProfile chromaticities colorInteropID dpx:Transfer oiio:RowsPerChunk oiio:BitsPerSample "
    b"oiio:UnassociatedAlpha oiio:ColorSpace tiff:PhotometricInterpretation tiff:ColorSpace "
    b"jpeg:ColorSpace psd:ColorMode compression Orientation cutis:calibration cutis:edits "
    b"cutis:source cutis:model name textureformat"
).split()


def _value(random: Random) -> tuple[bytes, bytes]:
    """An OpenEXR type and a value of it."""
    number = random.choice(_NUMBERS)
    words = (b"3", b"sRGB", b"CMYK", b"[]", b"{}", b"[[1]]", b"\xff\xfe", b"\x1b[2J", b"nan")
    text = random.choice((*words, b"{" * 5000, b"9" * 400))
    return random.choice(
        (
            (b"int", struct.pack("<I", number)),
            (b"float", struct.pack("<I", number)),
            (b"double", struct.pack("<Q", number)),
            (b"string", text),
            (b"v2f", bytes(8)),
            (b"m44f", bytes(64)),
            (b"chromaticities", struct.pack("<8I", *(random.choice(_NUMBERS) for _ in range(8)))),
            (b"floatvector", bytes(32)),
            (b"stringvector", struct.pack("<I", len(text)) + text),
        )
    )


def _exr_named(content: bytes, other: bytes, random: Random) -> bytes:
    """One more attribute, of a name that means something and any type; chunks stay readable."""
    kind, value = _value(random)
    more = random.choice(_NAMES) + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value
    at = 8
    while at < len(content) and content[at]:
        name = content.find(b"\0", at)
        end = content.find(b"\0", name + 1)
        if min(name, end) < 0:
            return content
        at = end + 5 + struct.unpack("<I", content[end + 1 : end + 5].ljust(4, b"\0"))[0]
    table = at + 1
    if table + 8 > len(content):
        return content
    (first,) = struct.unpack("<Q", content[table : table + 8])
    if content[5] & 16 or not table < first <= len(content) or (first - table) % 8:
        return content[:8] + more + content[8:]
    offsets = struct.unpack(f"<{(first - table) // 8}Q", content[table:first])
    moved = struct.pack(f"<{len(offsets)}Q", *((o + len(more)) % 2**64 for o in offsets))
    return content[:8] + more + content[8:table] + moved + content[first:]


def _png_named(content: bytes, other: bytes, random: Random) -> bytes:
    """One more text, under a name that means something."""
    chunks = _png_chunks(content)
    text = random.choice(_NAMES) + b"\0" + _value(random)[1]
    chunks.insert(random.randrange(1, len(chunks)), (b"tEXt", text))
    return _png_join(chunks)


def _exr_version(content: bytes, other: bytes, random: Random) -> bytes:
    """The flags that say tiled, long names, deep, several parts."""
    out = bytearray(content)
    out[5] ^= random.choice((2, 4, 8, 16, 2 | 8, 16 | 8))
    return bytes(out)


def _jpeg_segment(content: bytes, other: bytes, random: Random) -> bytes:
    """Damage within one segment, or its marker or length."""
    at, found = 2, []
    while at + 4 <= len(content) and content[at] == 0xFF and content[at + 1] != 0xDA:
        length = struct.unpack(">H", content[at + 2 : at + 4])[0]
        found.append((at, length))
        at += 2 + length
    if not found:
        return content
    start, length = random.choice([*found, (at, 14)])
    how = random.randrange(4)
    out = bytearray(content)
    if how == 0:
        out[start + 1] = random.choice((0xC0, 0xC1, 0xC2, 0xC3, 0xC9, 0xDD, 0xE1, 0xE2, 0xED, 0xEE))
    elif how == 1:
        return content[:start] + content[start : start + 2 + length] + content[start:]
    else:
        part = random.choice((_flip, _number))(content[start : start + 2 + length], other, random)
        out[start : start + 2 + length] = part
    return bytes(out)


def _fields(layout: tuple[tuple[int, str], ...]) -> Callable[[bytes, bytes, Random], bytes]:
    """Damage to numbers at known places of a header."""

    def damage(content: bytes, other: bytes, random: Random) -> bytes:
        out = bytearray(content)
        for _ in range(random.choice((1, 1, 2))):
            at, code = random.choice(layout)
            size = struct.calcsize(code)
            if at + size <= len(out):
                value = random.choice(_NUMBERS) & (2 ** (8 * size) - 1)
                struct.pack_into(code, out, at, value)
        return bytes(out)

    return damage


# Offset of the data, sizes, elements: number, sign, transfer, bits, packing, run lengths, offset.
_DPX = (
    *((at, ">I") for at in (4, 16, 20, 24, 28, 772, 776, 780, 784, 788, 792, 796, 808, 812, 816)),
    *((at, ">H") for at in (768, 770, 804, 806)),
    *((at, "B") for at in (800, 801, 802, 803, 1432)),
)
_PSD = (
    *((at, ">H") for at in (4, 12, 22, 24)),
    *((at, ">I") for at in (14, 18, 26, 30, 34, 38, 42, 46, 50, 54, 58)),
)
_OWN: dict[bytes, dict[str, Callable[[bytes, bytes, Random], bytes]]] = {
    b"\x89PNG": {
        "png field": _png_field,
        "png order": _png_order,
        "png inside": _png_inside,
        "png named": _png_named,
    },
    b"II": {"tiff entry": _tiff_entry},
    b"MM": {"tiff entry": _tiff_entry},
    b"v/1\x01": {
        "exr attribute": _exr_attribute,
        "exr flags": _exr_version,
        "exr named": _exr_named,
    },
    b"\xff\xd8": {"jpeg segment": _jpeg_segment},
    b"SDPX": {"dpx field": _fields(_DPX)},
    b"XPDS": {"dpx field": _fields(_DPX)},
    b"8BPS": {"psd field": _fields(_PSD)},
    b"\x93NUMPY": {"npy header": _npy_header},
}
