import numpy as np
import pytest
from PIL import Image

from cutis.errors import CutisError
from cutis.textures import MaskFile, read_mask, write_channels


def refused(path, shape, one_line, match):
    with pytest.raises(CutisError, match=match) as caught:
        read_mask(path, shape)
    return one_line(caught, path)


@pytest.mark.parametrize(
    ("extension", "dtype", "largest"),
    [("png", "uint8", 255), ("png", "uint16", 65535), ("tif", "uint8", 255), ("exr", "float32", 1)],
)
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_stored_values_count_as_they_are(tmp_path, make, extension, dtype, largest, count):
    random = np.random.default_rng(3)
    pixels = (random.random((5, 7, count)) * largest).astype(dtype)
    straight = {"oiio:UnassociatedAlpha": 1} if count in (2, 4) and extension != "exr" else None
    path = make.image(tmp_path / f"m.{extension}", pixels, attributes=straight)
    if (extension, count) == ("exr", 2):  # sorted by name on the way: A comes before Y
        pixels = pixels[..., ::-1]
    stored = make.read(path)[0] / largest
    mask = read_mask(path, (5, 7))
    expected = stored[..., 0] if count < 3 else stored[..., :3].mean(-1)
    assert mask.dtype == np.float32
    np.testing.assert_allclose(mask, expected, atol=1e-6)


def test_jpeg_palette_and_one_bit(tmp_path, make):
    white = np.full((4, 4, 1), 255, np.uint8)
    assert read_mask(make.image(tmp_path / "m.jpg", white), (4, 4)).min() == 1
    rows = (b"\0" + bytes([3, 3, 0, 0])) * 4
    path = make.png(tmp_path / "p.png", 4, 4, colour=3, rows=rows)
    assert 0.02 < read_mask(path, (4, 4)).max() < 0.1  # expanded: the palette is nearly black
    bits = make.tiff(tmp_path / "b.tif", 8, 2, 1, bits=1, photometric=1, data=b"\xaa\xaa")
    assert read_mask(bits, (2, 8)).tolist() == [[1, 0] * 4] * 2


def test_values_clip_to_the_unit_interval(tmp_path, make):
    path = make.image(tmp_path / "m.exr", np.array([[[-3], [0.5], [7]]], np.float32))
    assert read_mask(path, (1, 3)).tolist() == [[0, 0.5, 1]]


def test_the_channel_called_mask_wins(tmp_path):
    path = tmp_path / "maps.exr"
    inside = np.array([[0.0, 1.0]])
    write_channels(path, {"blood": inside * 0 + 0.7, "mask": inside, "x": inside, "y": inside})
    assert read_mask(path, (1, 2)).tolist() == inside.tolist()


def test_refusals(tmp_path, make, one_line):
    path = make.image(tmp_path / "m.png", np.full((5, 7, 1), 255, np.uint8))
    message = refused(path, (7, 5), one_line, "resize")
    assert "7 × 5" in message
    assert "5 × 7" in message
    dark = make.image(tmp_path / "d.png", np.full((5, 7, 1), 5, np.uint8))
    refused(dark, (5, 7), one_line, "empty")
    faint = make.image(tmp_path / "f.png", np.full((5, 7, 1), 102, np.uint8))
    assert read_mask(faint, (5, 7)) == pytest.approx(0.4)
    bad = make.image(tmp_path / "n.exr", np.full((5, 7, 1), np.nan, np.float32))
    refused(bad, (5, 7), one_line, "NaN")
    other = make.image(tmp_path / "o.exr", np.ones((5, 7, 3), np.float32), ["X", "Y", "Z"])
    refused(other, (5, 7), one_line, "called mask")
    refused(tmp_path / "none.png", (5, 7), one_line, "no such file")


INSIDE = np.zeros((48, 64), np.uint8)
INSIDE[10:30, 10:40] = 255
PHOTO = np.random.default_rng(5).integers(40, 200, (48, 64, 3)).astype(np.uint8)


def saved(path, *planes):
    Image.fromarray(np.dstack(planes) if len(planes) > 1 else planes[0]).save(path)
    return path


@pytest.mark.parametrize(
    ("planes", "word"),
    [
        ((np.full_like(INSIDE, 255),), "in its alpha"),  # white everywhere, LA
        ((np.zeros_like(INSIDE),), "in its alpha"),
        ((np.full_like(INSIDE, 255),) * 3, "in its alpha"),  # RGBA
        ((np.zeros_like(INSIDE),) * 3, "in its alpha"),
        ((np.full_like(INSIDE, 200), INSIDE * 0, INSIDE * 0), "in its alpha"),  # a red overlay
        ((PHOTO[..., 0], PHOTO[..., 1], PHOTO[..., 2]), "in its alpha"),  # a cut-out face
        ((INSIDE,) * 3, "in its alpha"),  # white paint on a transparent layer
    ],
)
@pytest.mark.parametrize("kind", ["png", "tif"])
def test_alpha_that_is_the_mask_counts(tmp_path, planes, word, kind):
    path = saved(tmp_path / f"m.{kind}", *planes, INSIDE)
    assert np.array_equal(read_mask(path, (48, 64)), INSIDE / 255)
    with MaskFile(path, (48, 64)) as file:
        assert word in file.notes[0]
        assert np.array_equal(file.rows(slice(5, 20)), INSIDE[5:20] / 255)


def test_soft_edges_of_alpha(tmp_path):
    soft = np.tile(np.clip(np.arange(64) * 40.0 - 1200, 0, 255).astype(np.uint8), (48, 1))
    path = saved(tmp_path / "m.png", *(np.full_like(soft, 255),) * 3, soft)
    np.testing.assert_allclose(read_mask(path, (48, 64)), soft / 255, atol=1e-6)


@pytest.mark.parametrize("alpha", [0, 128, 255])
def test_alpha_that_says_nothing_is_not_the_mask(tmp_path, alpha):
    path = saved(tmp_path / "m.png", *(INSIDE,) * 3, np.full_like(INSIDE, alpha))
    assert np.array_equal(read_mask(path, (48, 64)), INSIDE / 255)


def test_two_masks_in_one_picture_show_what_a_viewer_shows(tmp_path):
    other = np.zeros_like(INSIDE)
    other[:, 20:] = 255
    path = saved(tmp_path / "m.png", *(INSIDE,) * 3, other)
    assert np.array_equal(read_mask(path, (48, 64)), INSIDE / 255 * (other > 0))
    with MaskFile(path, (48, 64)) as file:
        assert file.notes == ["the mask is its colour where its alpha channel is opaque"]


def test_multiplied_alpha_is_in_the_colour_already(tmp_path, make):
    alpha = INSIDE[..., None].astype(np.float32) / 255
    alpha[10] = 0.5
    path = make.image(tmp_path / "m.exr", np.concatenate([alpha * 1.0] * 4, -1))
    np.testing.assert_allclose(read_mask(path, (48, 64)), alpha[..., 0])


def test_a_palette_with_transparency(tmp_path):
    picture = Image.fromarray((INSIDE > 0).astype(np.uint8), "P")
    picture.putpalette([255, 255, 255] * 2)
    picture.save(tmp_path / "m.png", transparency=0)
    assert np.array_equal(read_mask(tmp_path / "m.png", (48, 64)), INSIDE / 255)
