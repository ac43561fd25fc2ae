"""Pictures of the report page: reduced, in colours that tell the truth, and not too large."""

import io

import numpy as np
import pytest
from PIL import Image

from cutis.report.pictures import LEVELS, coloured, data_uri, difference, photograph, reduced
from cutis.report.scale import Scale


def pixels(picture, mode):
    data, size = picture
    with Image.open(io.BytesIO(data)) as image:
        assert image.size == size
        return np.asarray(image.convert(mode))


def test_maps_have_the_colours_of_their_scale_and_none_outside_the_mask():
    from matplotlib import colormaps

    values = np.array([[0.1, 0.2, np.nan], [0.3, 0.9, 0.0]], np.float32)
    shown = pixels(coloured(values, "viridis", Scale(0.1, 0.3)), "RGBA")
    expected = colormaps["viridis"]([[0, 0.5, 0], [1, 1, 0]], bytes=True)
    known = np.isfinite(values)
    assert np.array_equal(shown[..., 3], np.where(known, 255, 0))
    apart = np.abs(shown[known].astype(int) - expected[known])
    assert apart.max() <= 255 / (LEVELS - 1)


def test_photographs_keep_their_colours():
    flat = np.broadcast_to(np.array([0.8, 0.6, 0.5], np.float32), (40, 30, 3))
    shown = pixels(photograph(flat), "RGB")
    assert np.abs(shown - 255 * flat).max() <= 3


def test_large_photographs_are_reduced_to_what_a_page_can_hold():
    noise = np.random.default_rng(3).random((1200, 1500, 3), np.float32)
    data, (width, height) = photograph(noise)
    assert len(data) <= 200_000
    assert max(width, height) < 900
    assert width / height == pytest.approx(1500 / 1200, rel=0.02)


def test_large_maps_are_reduced_too():
    noise = np.random.default_rng(3).random((1200, 1500), np.float32)
    data, (width, height) = coloured(noise, "viridis", Scale(0, 1))
    assert len(data) <= 200_000
    assert max(width, height) < 900


def test_reducing_takes_means_of_what_is_known():
    values = np.arange(64, dtype=np.float32).reshape(8, 8)
    assert np.allclose(reduced(values, 4), values.reshape(4, 2, 4, 2).mean(axis=(1, 3)))
    values[:2, :2] = [[7, np.nan], [9, np.nan]]
    values[:2, 2:4] = [[np.nan, np.nan], [np.nan, 5]]
    small = reduced(values, 4)
    assert small[0, 0] == 8
    assert np.isnan(small[0, 1])
    assert reduced(np.ones((1, 5000), np.float32), 500).shape == (1, 500)
    assert reduced(values, 900).shape == (8, 8)


def test_the_difference_is_four_times_that_of_encoded_colours():
    from cutis.colour import decode_srgb

    capture, model = (decode_srgb(np.full((2, 2, 3), v)) for v in (0.5, 0.55))
    assert difference(capture, model) == pytest.approx(0.2)
    assert difference(capture, np.zeros((2, 2, 3))) == pytest.approx(1)


def test_pictures_know_their_kind():
    flat = np.full((2, 2), 0.5, np.float32)
    assert data_uri(coloured(flat, "magma", Scale(0, 1))[0]).startswith("data:image/png;base64,")
    assert data_uri(photograph(flat[..., None] * np.ones(3))[0]).startswith("data:image/jpeg;")
