"""MIP levels against means over areas, computed texel by texel, and against OpenImageIO's."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.textures.mip import Half, Pyramid


def half_by_area(image):
    """Each texel of the half is the mean of what it covers: every texel cut into as many parts."""
    height, width = image.shape[:2]
    rows, columns = max(1, height // 2), max(1, width // 2)
    parts = image.repeat(rows, axis=0).repeat(columns, axis=1)
    return parts.reshape(rows, height, columns, width, -1).mean(axis=(1, 3))


def whole(image, dtype, folder, step):
    pyramid = Pyramid(image.shape, np.dtype(dtype), folder)
    for top in range(0, len(image), step):
        pyramid.push(image[top : top + step])
    found = [(shape, np.concatenate(list(rows))) for shape, rows in pyramid.levels()]
    pyramid.close()
    assert all(shape == level.shape for shape, level in found)
    return [level for _, level in found]


@pytest.mark.parametrize("size", [(8, 8), (7, 5), (1, 9), (9, 1), (2, 3), (33, 20), (1, 2)])
@pytest.mark.parametrize("step", [1, 2, 3, 64])
def test_means_over_areas(tmp_path, random, size, step):
    image = random.random((*size, 3)).astype(np.float32)
    expected = image.astype(np.float64)
    for level in whole(image, "float32", tmp_path, step):
        expected = half_by_area(expected)
        np.testing.assert_allclose(level, expected, atol=1e-6)
    assert level.shape == (1, 1, 3)
    np.testing.assert_allclose(level[0, 0], image.mean(axis=(0, 1)), atol=1e-6)


def test_one_texel_has_no_levels(tmp_path):
    assert whole(np.zeros((1, 1, 3), np.uint8), "uint8", tmp_path, 1) == []


def test_a_half_says_its_shape():
    assert Half((9, 1, 4)).shape == (4, 1, 4)


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float16"])
def test_values_are_rounded_once(tmp_path, random, dtype):
    scale = 1 if dtype == "float16" else np.iinfo(dtype).max
    image = (random.random((16, 16, 3)) * scale).astype(dtype)
    expected = image.astype(np.float64)
    for level in whole(image, dtype, tmp_path, 5):
        expected = half_by_area(expected)
        assert level.dtype == dtype
        assert abs(level - expected).max() <= (5e-4 if dtype == "float16" else 0.5 + 1e-3)


def test_against_openimageio(tmp_path, random):
    image = random.random((64, 128, 3)).astype(np.float32)
    buffer = oiio.ImageBuf(oiio.ImageSpec(128, 64, 3, "float"))
    assert buffer.set_pixels(oiio.ROI(), image)
    path = str(tmp_path / "theirs.tx")
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, buffer, path, oiio.ImageSpec())
    source = oiio.ImageInput.open(path)
    for number, level in enumerate(whole(image, "float32", tmp_path, 10), 1):
        theirs = source.read_image(0, number, 0, 3, "float")
        np.testing.assert_allclose(level, theirs, atol=1e-5)
    assert not source.seek_subimage(0, number + 1)
    source.close()
