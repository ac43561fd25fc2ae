"""What the look through a PNG finds, and that it finds no more than is wrong."""

import struct
import zlib
from random import Random

import numpy as np
import OpenImageIO as oiio
import pytest
from hostile.mutations import mutate
from hostile.seeds import png, png_chunk, seeds

from cutis.errors import CutisError
from cutis.textures.png import check_png

SIGNATURE = b"\x89PNG\r\n\x1a\n"
ROWS = (b"\0" + bytes(15)) * 4  # 5 × 4 texels
END = png_chunk(b"IEND", b"")
DATA = png_chunk(b"IDAT", zlib.compress(ROWS))
HEADER = png_chunk(b"IHDR", struct.pack(">IIBBBBB", 5, 4, 8, 2, 0, 0, 0))


def check(path, content):
    path.write_bytes(content)
    with open(path, "rb") as file:
        file.seek(8)
        check_png(path, file)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return [p for p in seeds(tmp_path_factory.mktemp("seeds")) if p.suffix == ".png"]


def test_whole_ones_pass(tmp_path, whole):
    for path in whole:
        check(tmp_path / path.name, path.read_bytes())


@pytest.mark.parametrize("size", [(1, 1), (1, 32768), (32768, 1), (3, 5), (8, 8), (9, 17)])
@pytest.mark.parametrize("interlace", [0, 1])
@pytest.mark.parametrize(("colour", "bits"), [(0, 1), (0, 2), (3, 4), (2, 8), (6, 16)])
def test_rows_are_counted(tmp_path, size, interlace, colour, bits):
    width, height = size
    per = {0: 1, 3: 1, 2: 3, 6: 4}[colour] * bits
    steps = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
             (0, 1, 1, 2)] if interlace else [(0, 0, 1, 1)]  # fmt: skip
    count = sum(
        len(range(y, height, down)) * (1 + (len(range(x, width, across)) * per + 7) // 8)
        for x, y, across, down in steps
        if x < width
    )
    how = {"colour": colour, "bits": bits, "interlace": interlace}
    check(tmp_path / "a.png", png(width, height, bytes(count), **how))
    check(tmp_path / "a.png", png(width, height, bytes(count + 99_999), **how))  # ignored
    with pytest.raises(CutisError, match="rows are missing"):
        check(tmp_path / "a.png", png(width, height, bytes(count - 1), **how))


@pytest.mark.parametrize(
    ("chunks", "match"),
    [
        (HEADER + DATA, "truncated"),
        (HEADER + DATA + END[:-1], "truncated"),
        (HEADER + DATA[:-1] + b"x" + END, "checksum"),
        (HEADER + END, "rows are missing"),
        (DATA + END, "header is missing"),
        (png_chunk(b"IHDR", bytes(12)) + DATA + END, "header is missing"),
        (HEADER + HEADER + DATA + END, "twice"),
        (HEADER + png_chunk(b"HuGe", b"x") + DATA + END, "no program knows"),
        (HEADER + png_chunk(b"i\0\0\0", b"x") + DATA + END, "no program knows"),
        (HEADER + png_chunk(b"IDAT", zlib.compress(ROWS)[:-4]) + END, "rows are missing"),
        (HEADER + png_chunk(b"IDAT", zlib.compress(ROWS)[:-1] + b"x") + END, "unpacked"),
        (HEADER + png_chunk(b"IDAT", b"\0" * 9) + END, "unpacked"),
    ],
)
def test_chunks(tmp_path, chunks, match):
    check(tmp_path / "a.png", SIGNATURE + HEADER + DATA + END)
    with pytest.raises(CutisError, match=match):
        check(tmp_path / "a.png", SIGNATURE + chunks)


@pytest.mark.parametrize(
    "fields",
    [(3, 2, 0, 0, 0), (8, 1, 0, 0, 0), (16, 3, 0, 0, 0), (8, 2, 1, 0, 0), (8, 2, 0, 1, 0),
     (8, 2, 0, 0, 2)],
)  # fmt: skip
def test_headers_that_make_no_sense(tmp_path, fields):
    header = png_chunk(b"IHDR", struct.pack(">IIBBBBB", 5, 4, *fields))
    with pytest.raises(CutisError, match="makes no sense"):
        check(tmp_path / "a.png", SIGNATURE + header + DATA + END)


def test_filters(tmp_path):
    for row in range(4):
        rows = bytearray(ROWS)
        rows[16 * row] = 5
        with pytest.raises(CutisError, match="unknown way"):
            check(tmp_path / "a.png", png(5, 4, bytes(rows)))
        rows[16 * row] = 4
        check(tmp_path / "a.png", png(5, 4, bytes(rows)))


def test_palettes(tmp_path):
    rows = (b"\0" + bytes(5)) * 4
    check(tmp_path / "a.png", png(5, 4, rows, colour=3))
    palette = png_chunk(b"PLTE", bytes(range(48)))
    for other in (b"", png_chunk(b"PLTE", bytes(4)), png_chunk(b"PLTE", bytes(771))):
        with pytest.raises(CutisError, match="palette"):
            check(tmp_path / "a.png", png(5, 4, rows, colour=3).replace(palette, other))


def test_nothing_passes_that_the_decoder_complains_of(tmp_path, whole, capfd):
    """400 damaged files: of those that pass, OpenImageIO reads all in silence."""
    path, passed = tmp_path / "a.png", 0
    for number in range(400):
        random = Random(number)
        one, other = random.choice(whole), random.choice(whole)
        _, content = mutate(one.read_bytes(), other.read_bytes(), random)
        if not content.startswith(SIGNATURE):
            continue
        try:
            check(path, content)
        except CutisError:
            continue
        source = oiio.ImageInput.open(str(path))
        assert source is not None, oiio.geterror()
        pixels = source.read_image(0, 0, 0, source.spec().nchannels, source.spec().format)
        assert isinstance(pixels, np.ndarray)
        assert source.geterror() == ""
        source.close()
        passed += 1
    assert capfd.readouterr() == ("", "")
    assert passed > 40
