"""Pictures of the report page: colours, scales and histograms that tell the truth."""

import io
import re

import numpy as np
import pytest
from PIL import Image

from cutis.report.page_figures import (
    LEVELS,
    Histogram,
    Scale,
    coloured,
    data_uri,
    difference,
    histogram_svg,
    photograph,
    reduced,
    scale_of,
)


def pixels(picture, mode):
    data, size = picture
    with Image.open(io.BytesIO(data)) as image:
        assert image.size == size
        return np.asarray(image.convert(mode))


@pytest.mark.parametrize("root", [1, 3, 4])
def test_places_of_a_scale_are_even_in_the_root(root):
    scale = Scale(0.01, 0.5, root)
    assert scale.place([0.01, 0.5, 0.001, 2.0]) == pytest.approx([0, 1, 0, 1])
    assert np.isnan(scale.place(np.nan))
    middle = ((0.01 ** (1 / root) + 0.5 ** (1 / root)) / 2) ** root
    assert scale.place(middle) == pytest.approx(0.5)
    assert scale.value(0.5) == pytest.approx(middle)


def test_a_scale_leaves_out_the_emptiest_bins_only():
    counts = np.array([1, 0, 500, 499, 0, 1])
    scale = scale_of(Histogram(np.linspace(0, 6, 7), counts))
    assert (scale.low, scale.high) == (2, 4)
    even = scale_of(Histogram(np.linspace(0, 6, 7), np.full(6, 10)))
    assert (even.low, even.high) == (0, 6)


@pytest.mark.parametrize("value", [0.0, 0.02, 250.0])
def test_a_map_of_one_value_has_a_scale_that_holds_it(value):
    scale = scale_of(Histogram.of(np.full((3, 3), value)), 3)
    assert scale.low <= value <= scale.high
    assert np.isfinite(scale.place(value))


def test_a_histogram_counts_what_is_known():
    values = np.concatenate([np.linspace(0, 1, 1000), np.full(500, np.nan)])
    histogram = Histogram.of(values)
    assert len(histogram.edges) == 65
    assert 990 <= histogram.counts.sum() <= 1000
    assert Histogram.of(np.full(4, np.nan)).counts.sum() == 0


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


def test_areas_of_a_histogram_are_texels():
    """Also where bins differ in width on the scale, as they do under a root."""
    edges, counts = np.array([0.0, 0.001, 0.027, 0.343, 1.0]), np.array([10, 40, 30, 20])
    svg = histogram_svg(Histogram(edges, counts), Scale(0, 1, 3), (0.001, 0.027, 0.343), "bars")
    steps = re.findall(r"V([\d.]+)H([\d.]+)", svg)
    tops, rights = np.array(steps, float).T
    areas = np.diff(rights, prepend=0) * (64 - tops)
    assert areas / areas.sum() == pytest.approx(counts / 100, abs=0.005)
    assert 'x1="76.8"' in svg  # the median, 0.3 of the way
    assert 'aria-label="bars"' in svg


def test_a_histogram_without_a_median_has_no_line():
    svg = histogram_svg(Histogram(np.arange(3.0), np.ones(2)), Scale(0, 2), (np.nan,) * 3, "bars")
    assert "<line" not in svg
    assert "nan" not in svg
