"""Pictures stored turned, against what Pillow shows of them."""

import io

import handmade as hand
import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image, ImageOps

from cutis.colour import LINEAR
from cutis.errors import CutisError
from cutis.textures import LabelFile, MaskFile, TextureFile, read_mask, read_texture, write_texture
from cutis.textures.turning import as_stored, upright

ORIENTATIONS = range(1, 9)
BLOCKS = hand.texels(size=(6, 8)).repeat(16, axis=0).repeat(16, axis=1)  # that JPEG keeps apart


def shown(path):
    """What viewers show, by Pillow."""
    return np.asarray(ImageOps.exif_transpose(Image.open(path)))


def stored(path):
    """What viewers show that know no orientation; Pillow turns a TIFF whether asked or not."""
    return oiio.ImageBuf(str(path)).get_pixels("uint8")


def turned(path, orientation, order="<"):
    tags = {274: ("H", [orientation])}
    if path.suffix == ".jpg":
        return hand.jpeg(path, hand.jpeg_exif(tags, order), pixels=BLOCKS)
    if path.suffix == ".tif":
        return hand.tiff(path, tags, BLOCKS, order=order)
    return hand.png(path, (b"eXIf", hand.exif(tags, order)), pixels=BLOCKS)


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("kind", ["jpg", "png", "tif"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_texels_are_those_that_viewers_show(tmp_path, kind, orientation, order):
    path = turned(tmp_path / f"a.{kind}", orientation, order)
    one = read_texture(path)
    assert np.array_equal(one.pixels, shown(path))
    assert (one.turned, one.orientation) == (orientation, "auto")
    as_it_is = read_texture(path, orientation="ignore")
    assert np.array_equal(as_it_is.pixels, stored(path))
    with TextureFile(path) as file, TextureFile(path, orientation="ignore") as other:
        for rows in (slice(0, 5), slice(90, 128), slice(40, 40)):
            assert np.array_equal(file.rows(rows).pixels, one.pixels[rows])
        if orientation == 1:
            assert file.notes == other.notes == []
        else:
            assert (
                f"its orientation tag ({orientation}) says; --orientation ignore" in file.notes[0]
            )
            assert other.notes == [f"its orientation tag ({orientation}) is ignored, as asked for"]


def test_turned_there_and_back(random):
    values = random.random((4, 5, 2))
    for orientation in ORIENTATIONS:
        picture = upright(values, orientation)
        assert np.array_equal(as_stored(picture, orientation), values)
    assert picture.shape == (5, 4, 2)


@pytest.mark.parametrize("number", [0, 9, 65535])
def test_numbers_that_mean_nothing(tmp_path, number):
    one = read_texture(turned(tmp_path / "a.png", number))
    assert np.array_equal(one.pixels, BLOCKS)


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("kind", ["jpg", "png", "tif"])
def test_what_is_written_looks_like_what_came_in_any_viewer(tmp_path, kind, orientation):
    """One that turns pictures and one that does not: a format keeps how it is stored."""
    path = turned(tmp_path / f"a.{kind}", orientation)
    for wanted in ("auto", "ignore"):
        again = tmp_path / f"again.{kind}"
        write_texture(read_texture(path, orientation=wanted), again)
        slack = 3 if kind == "jpg" else 0
        for look in (shown, stored):
            assert look(again).shape == look(path).shape
            assert abs(look(again).astype(int) - look(path)).max() <= slack


@pytest.mark.parametrize("orientation", [3, 6, 7])
@pytest.mark.parametrize("kind", ["png", "tif", "exr", "tx", "dpx"])
def test_other_formats_hold_the_picture_upright(tmp_path, make, kind, orientation):
    path = turned(tmp_path / "a.jpg", orientation)
    write_texture(read_texture(path), tmp_path / f"b.{kind}")
    written, spec = make.read(tmp_path / f"b.{kind}")
    assert spec.get_int_attribute("Orientation", 1) == 1
    if written.dtype == np.uint8:
        assert np.array_equal(written, shown(path))
    write_texture(read_texture(path, orientation="ignore"), tmp_path / f"c.{kind}")
    kept, spec = make.read(tmp_path / f"c.{kind}")
    assert spec.get_int_attribute("Orientation", 1) == 1
    assert kept.shape == BLOCKS.shape


def test_an_edit_between_is_where_it_was_made(tmp_path):
    """A corner of the picture as shown, changed; the rest comes back bit for bit."""
    path = turned(tmp_path / "a.png", 6)
    one = read_texture(path)
    where = np.zeros(one.shape, bool)
    where[:20, :30] = True
    new = one.with_linear(one.linear() * 0.5, where)
    write_texture(new, tmp_path / "b.png")
    before, after = shown(path), shown(tmp_path / "b.png")
    assert np.array_equal((before != after).any(-1), where)


def test_openexr_has_no_orientation(tmp_path):
    path = hand.exr(tmp_path / "a.exr", hand.exr_numbers("Orientation", "int", 6))
    with TextureFile(path) as file:
        assert file.shape == hand.SIZE
        assert file.notes == [
            "its orientation tag (6) is not applied: viewers of such files do not"
        ]
    write_texture(read_texture(path), tmp_path / "b.tif", LINEAR)
    assert read_texture(tmp_path / "b.tif").shape == hand.SIZE


@pytest.mark.parametrize("orientation", [2, 3, 6, 8])
def test_masks_and_regions_lie_as_viewers_show_them(tmp_path, orientation):
    """Painted upright on what is shown, and as pictures that are stored turned themselves."""
    path = turned(tmp_path / "a.jpg", orientation)
    face = read_texture(path)
    upright_mask = np.zeros(face.shape, np.uint8)
    upright_mask[:32, :48] = 255
    Image.fromarray(upright_mask).save(tmp_path / "m.png")
    assert np.array_equal(read_mask(tmp_path / "m.png", face.frame), upright_mask / 255)
    tags = Image.Exif()
    tags[274] = orientation
    held = io.BytesIO()
    Image.fromarray(as_stored(upright_mask, orientation)).save(held, "PNG", exif=tags)
    (tmp_path / "t.png").write_bytes(held.getvalue())
    assert np.array_equal(read_mask(tmp_path / "t.png", face.frame), upright_mask / 255)
    with MaskFile(tmp_path / "t.png", face.frame) as mask:
        assert "as its orientation tag" in mask.notes[0]
    with LabelFile(tmp_path / "t.png", face.frame) as labels:
        assert np.array_equal(labels.rows(slice(None)) > 0, upright_mask > 0)
    if orientation >= 5:
        with pytest.raises(CutisError, match="128 × 96 texels, the texture 96 × 128"):
            read_mask(tmp_path / "t.png", face.frame, "ignore")


def test_a_turned_picture_larger_than_memory_is_refused(tmp_path, monkeypatch, one_line):
    path = turned(tmp_path / "a.png", 6)
    monkeypatch.setattr("cutis.textures.decoding.available_memory", lambda: 1000)
    with TextureFile(path) as file, pytest.raises(CutisError, match="memory") as caught:
        file.rows(slice(0, 1))
    one_line(caught, path)
