"""Files of several pictures: which is read, and what is said of the others."""

import struct

import handmade as hand
import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.errors import CutisError
from cutis.textures import TextureFile, read_mask, read_texture, write_texture

FULL = hand.texels("uint8", (24, 32))
SMALL = FULL[::4, ::4].copy()
GREY = FULL[..., :1].copy()


def read(path):
    with TextureFile(path) as file:
        return file.rows(slice(None)).pixels, file.notes


def page(pixels, **tags):
    known = {"kind": 254, "old": 255}
    return {known[name]: ("I" if name == "kind" else "H", [v]) for name, v in tags.items()}, pixels


@pytest.mark.parametrize(
    ("pages", "number", "word"),
    [
        ([page(SMALL, kind=1), page(FULL, kind=0)], 1, "page 1 (8 × 6) is left out"),
        ([page(SMALL, old=2), page(FULL)], 1, "of 2 pictures page 2 (32 × 24) is read and edited"),
        ([page(SMALL), page(FULL)], 1, "page 1 (8 × 6) is left out"),
        ([page(FULL), page(SMALL, kind=1)], 0, None),
        ([page(FULL), page(SMALL)], 0, None),
        ([page(FULL), page(FULL // 2)], 0, "page 2 (32 × 24) is left out"),
        ([page(GREY), page(FULL)], 1, "page 1 (32 × 24) is left out"),
        ([page(GREY, kind=4), page(SMALL, kind=1), page(FULL)], 2, "page 1 (32 × 24), page 2"),
        ([page(FULL), page(FULL[:, :31].copy())], 0, "page 2 (31 × 24) is left out"),
    ],
)
@pytest.mark.parametrize("order", ["<", ">"])
def test_pages_of_a_tiff(tmp_path, pages, number, word, order):
    (tags, first), *more = pages
    path = hand.tiff(tmp_path / "a.tif", tags, first, more, order)
    pixels, notes = read(path)
    assert np.array_equal(pixels, pages[number][1])
    assert (word is None and not notes) or word in notes[0]


def test_orientation_and_colour_are_those_of_the_page(tmp_path):
    tags, full = page(FULL)
    tags |= {274: ("H", [6]), 301: ("H", np.linspace(0, 65535, 256).astype(int).tolist())}
    path = hand.tiff(tmp_path / "a.tif", *page(SMALL, kind=1), more=[(tags, full)])
    one = read_texture(path)
    assert one.shape == (32, 24)
    assert one.space.name == "linear"


def test_a_raw_photograph_holds_its_picture_elsewhere(tmp_path, one_line):
    tags, small = page(SMALL, kind=1)
    path = hand.tiff(tmp_path / "a.dng", tags | {330: ("I", [8])}, small)
    with pytest.raises(CutisError, match="only raw converters look") as caught:
        read_texture(path)
    one_line(caught, path)


def parts(path, *named):
    """An OpenEXR of parts (name, channels, pixels)."""
    specs = []
    for name, channels, pixels in named:
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float")
        spec.channelnames = tuple(channels)
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), tuple(specs)), out.geterror()
    for number, (_, _, pixels) in enumerate(named):
        if number:
            assert out.open(str(path), specs[number], "AppendSubimage")
        assert out.write_image(np.ascontiguousarray(pixels))
    assert out.close()
    return path


LINEAR_FULL = hand.texels("float32", (24, 32))


def test_parts_of_an_openexr(tmp_path):
    depth = ("depth", "Z", LINEAR_FULL[..., :1])
    left, right = ("left", "RGB", LINEAR_FULL), ("right", "RGB", LINEAR_FULL * 2)
    pixels, notes = read(parts(tmp_path / "d.exr", depth, left))
    assert np.array_equal(pixels, LINEAR_FULL)
    assert notes == [
        "of 2 pictures part 2 left (32 × 24) is read and edited; part 1 depth (32 × 24) is left out"
    ]
    path = parts(tmp_path / "s.exr", left, right, depth)
    pixels, notes = read(path)
    assert np.array_equal(pixels, LINEAR_FULL)
    assert "part 2 right (32 × 24), part 3 depth (32 × 24) are left out" in notes[0]
    write_texture(read_texture(path), tmp_path / "out.exr")
    assert read(tmp_path / "out.exr")[1] == []


def test_no_part_in_rgb(tmp_path, one_line):
    depth = ("depth", "Z", LINEAR_FULL[..., :1])
    path = parts(tmp_path / "d.exr", depth, ("more", "Z", LINEAR_FULL[..., :1]))
    with pytest.raises(CutisError, match="is a grey image") as caught:
        read_texture(path)
    one_line(caught, path)


def test_a_mask_may_be_grey_and_not_a_thumbnail(tmp_path):
    tags, small = page(SMALL[..., :1].copy(), kind=1)
    path = hand.tiff(tmp_path / "m.tif", tags, small, [page(GREY)])
    np.testing.assert_allclose(read_mask(path, (24, 32)), GREY[..., 0] / 255, atol=1e-6)


def test_further_pictures_of_jpeg_and_png_are_named(tmp_path):
    path = hand.jpeg(tmp_path / "a.jpg", (0xE2, b"MPF\0II*\0" + bytes(20)))
    assert read(path)[1] == ["the file holds further pictures (MPF); its first picture is read"]
    path = hand.png(tmp_path / "a.png", (b"acTL", struct.pack(">II", 2, 0)))
    assert read(path)[1] == ["the file is an animation; its first picture is read"]
