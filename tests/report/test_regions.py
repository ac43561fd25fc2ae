"""Statistics by region of a picture."""

import dataclasses

import numpy as np
import pytest
from PIL import Image

from cutis.errors import CutisError
from cutis.maps import estimate
from cutis.optics import NAMES
from cutis.report import Regions


@pytest.fixture(scope="module")
def skin(face_rgb):
    return estimate(face_rgb)


@pytest.fixture
def picture(skin, tmp_path):
    pixels = np.zeros((*skin.shape, 3), np.uint8)
    pixels[:10, :12] = (255, 0, 0)
    pixels[10:, 12:] = (0, 128, 255)
    Image.fromarray(pixels).save(tmp_path / "regions.png")
    return tmp_path / "regions.png"


@pytest.mark.parametrize("rows", [24, 5])
def test_numbers_of_each_colour(skin, picture, rows):
    regions = Regions(picture, skin.shape)
    for top in range(0, skin.shape[0], rows):
        part = slice(top, min(top + rows, skin.shape[0]))
        regions.add(skin.rows(part), part)
    red, blue = sorted(regions.finish(), key=lambda one: one.name, reverse=True)
    assert (red.name, red.texels) == ("#ff0000", 120)
    assert (blue.name, blue.texels) == ("#0080ff", 14 * 20)
    for name in NAMES:
        values = getattr(skin, name)[:10, :12]
        expected = np.percentile(values, 50, method="inverted_cdf")
        assert red.maps[name].median == pytest.approx(expected, rel=1e-3)


def test_off_the_mask_is_in_no_region(skin, picture):
    mask = np.zeros(skin.shape, np.float32)
    mask[:2] = 1
    regions = Regions(picture, skin.shape)
    narrow = dataclasses.replace(skin, found=dataclasses.replace(skin.found, mask=mask))
    regions.add(narrow, slice(0, skin.shape[0]))
    assert [one.texels for one in regions.finish()] == [24]


def test_other_sizes_and_soft_edges(skin, tmp_path):
    Image.new("RGB", (3, 4), (255, 0, 0)).save(tmp_path / "small.png")
    with pytest.raises(CutisError, match="3 × 4"):
        Regions(tmp_path / "small.png", skin.shape)
    many = np.random.default_rng(0).integers(0, 255, (*skin.shape, 3), np.uint8)
    Image.fromarray(many).save(tmp_path / "soft.png")
    with pytest.raises(CutisError, match="more than 32"):
        Regions(tmp_path / "soft.png", skin.shape).add(skin, slice(0, skin.shape[0]))
