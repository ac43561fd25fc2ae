"""Label pictures as programs write them, by Pillow."""

import numpy as np
import pytest
from PIL import Image

from cutis.errors import CutisError
from cutis.textures import LabelFile

SIZE = (12, 16)
RED, GREEN = 0xFF0000, 0x00FF00


@pytest.fixture
def flat():
    """(H, W, 3) black on top, then red, then green."""
    colours = np.zeros((*SIZE, 3), np.uint8)
    colours[4:8, :, 0] = 255
    colours[8:, :, 1] = 255
    return colours


def labels(path, shape=SIZE):
    with LabelFile(path, shape) as file:
        return file.rows(slice(None))


def test_rgb(tmp_path, flat):
    Image.fromarray(flat).save(tmp_path / "r.png")
    found = labels(tmp_path / "r.png")
    assert found.dtype == np.int32
    assert np.unique(found[:4]).tolist() == [0]
    assert np.unique(found[4:8]).tolist() == [RED]
    assert np.unique(found[8:]).tolist() == [GREEN]


def test_a_palette_is_the_usual_form(tmp_path, flat):
    indices = np.zeros(SIZE, np.uint8)
    indices[4:8], indices[8:] = 1, 2
    picture = Image.fromarray(indices, "P")
    picture.putpalette([0, 0, 0, 255, 0, 0, 0, 255, 0])
    picture.save(tmp_path / "p.png")
    assert np.unique(labels(tmp_path / "p.png")).tolist() == [0, GREEN, RED]


@pytest.mark.parametrize("kind", ["png", "tif"])
def test_numbers_in_grey(tmp_path, kind):
    numbers = np.zeros(SIZE, np.uint8)
    numbers[4:8], numbers[8:] = 1, 2
    Image.fromarray(numbers).save(tmp_path / f"n.{kind}")
    assert np.unique(labels(tmp_path / f"n.{kind}")).tolist() == [0, 0x010101, 0x020202]


def test_what_is_transparent_is_no_region(tmp_path, flat):
    alpha = np.full(SIZE, 255, np.uint8)
    alpha[6:8] = 0
    Image.fromarray(np.dstack([flat, alpha])).save(tmp_path / "a.png")
    found = labels(tmp_path / "a.png")
    assert (found[6:8] == 0).all()
    assert (found[4:6] == RED).all()


@pytest.mark.parametrize("how", ["jpg", "tif", "exr"])
def test_lossy_pictures_are_refused(tmp_path, make, flat, how, one_line):
    path = tmp_path / f"r.{how}"
    if how == "exr":
        make.image(path, flat.astype(np.float16), attributes={"compression": "dwaa"})
    else:
        Image.fromarray(flat).save(path, **({"compression": "jpeg"} if how == "tif" else {}))
    with pytest.raises(CutisError, match=r"packed lossily .* save the regions as PNG") as caught:
        labels(path)
    one_line(caught, path)


def test_another_size_is_refused(tmp_path, flat, one_line):
    path = tmp_path / "r.png"
    Image.fromarray(flat).save(path)
    with pytest.raises(CutisError, match="16 × 12 texels, the texture 9 × 8; resize") as caught:
        labels(path, (8, 9))
    one_line(caught, path)
    with pytest.raises(CutisError, match="no such file"):
        labels(tmp_path / "none.png")
