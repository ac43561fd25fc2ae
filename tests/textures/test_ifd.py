"""Directories of tags, written by hand and by Pillow."""

import io

import handmade as hand
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from cutis.textures import ifd

TAGS = {
    256: ("I", [32]), 257: ("H", [24]), 274: ("H", [6]),
    319: ("R", (0.64, 0.33, 0.3, 0.6, 0.15, 0.06)),
    700: ("B", [60, 120, 62]),
    34665: {0xA001: ("H", [1]), 0xA500: ("R", [2.2]), 0xA005: {1: ("s", b"R98\0")}},
}  # fmt: skip


@pytest.mark.parametrize("order", ["<", ">"])
def test_values_and_directories_of_directories(order):
    found = ifd.exif_block(b"Exif\0\0" + hand.exif(TAGS, order))
    assert (found.number(ifd.WIDTH), found.number(ifd.HEIGHT)) == (32, 24)
    assert found.number(ifd.ORIENTATION, 1) == 6
    assert found.tags[ifd.PRIMARIES] == pytest.approx((0.64, 0.33, 0.3, 0.6, 0.15, 0.06))
    assert found.text(ifd.XMP) == b"<x>"
    assert ifd.whole(found.exif, ifd.EXIF_COLOUR_SPACE) == 1
    assert found.exif[ifd.EXIF_GAMMA] == pytest.approx((2.2,))
    assert found.interop[ifd.INTEROP_INDEX] == b"R98\0"
    assert found.number(ifd.COMPRESSION, 7) == 7
    assert found.text(ifd.WIDTH) == b"\x20"


def test_pages_as_pillow_writes_them(tmp_path):
    pages = [Image.new("RGB", (8 + n, 6)) for n in range(3)]
    pages[0].save(tmp_path / "a.tif", save_all=True, append_images=pages[1:])
    with (tmp_path / "a.tif").open("rb") as file:
        found = ifd.directories(file)
        assert [page.number(ifd.WIDTH) for page in found] == [8, 9, 10]
        assert len(ifd.directories(file, 2)) == 2


def test_bigtiff(tmp_path):
    Image.new("RGB", (9, 6)).save(tmp_path / "a.tif", big_tiff=True)
    with (tmp_path / "a.tif").open("rb") as file:
        assert [page.number(ifd.WIDTH) for page in ifd.directories(file)] == [9]


def test_a_chain_that_bites_its_tail_ends():
    content = bytearray(hand.exif({256: ("I", [3])}))
    content[8 + 2 + 12 : 8 + 2 + 12 + 4] = b"\x08\0\0\0"
    assert len(ifd.directories(io.BytesIO(bytes(content)))) == 1


@pytest.mark.parametrize(
    "content", [b"", b"II", b"II*\0", b"II*\0\xff\xff\xff\xff", b"MM\0+" + b"\xff" * 12]
)
def test_rubbish_is_left_out(content):
    assert ifd.directories(io.BytesIO(content)) in ([], [ifd.Directory()])
    assert ifd.exif_block(content) == ifd.Directory()


@given(data=st.binary(max_size=300), at=st.integers(0, 200), order=st.sampled_from("<>"))
@settings(max_examples=300, derandomize=True, database=None)
def test_damage_never_raises(data, at, order):
    content = bytearray(hand.exif(TAGS, order))
    content[at : at + len(data)] = data
    for page in ifd.directories(io.BytesIO(bytes(content))):
        assert all(isinstance(v, tuple | bytes) for v in page.tags.values())
        page.number(ifd.ORIENTATION)
        page.text(ifd.XMP)


def test_infinite_numbers_are_no_whole_ones():
    assert ifd.whole({1: (float("inf"),)}, 1, 4) == 4
    assert ifd.whole({1: (float("nan"),)}, 1, 4) == 4
    assert ifd.whole({1: b"text"}, 1, 4) == 4
    assert np.isnan(ifd.exif_block(hand.exif({318: ("R", (0,))})[:-8] + bytes(8)).tags[318][0])
