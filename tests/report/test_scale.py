"""Colour scales and histograms."""

import numpy as np
import pytest

from cutis.report.numbers import Bars
from cutis.report.scale import Scale, bars_of, scale_of, tick_text


@pytest.mark.parametrize("root", [1, 3, 4])
def test_places_of_a_scale_are_even_in_the_root(root):
    scale = Scale(0.01, 0.5, root)
    assert scale.place([0.01, 0.5, 0.001, 2.0]) == pytest.approx([0, 1, 0, 1])
    assert np.isnan(scale.place(np.nan))
    middle = ((0.01 ** (1 / root) + 0.5 ** (1 / root)) / 2) ** root
    assert scale.place(middle) == pytest.approx(0.5)
    assert scale.value(0.5) == pytest.approx(middle)


def test_a_scale_leaves_out_the_emptiest_bins_only():
    counts = (1, 0, 500, 499, 0, 1)
    scale = scale_of(Bars(tuple(np.linspace(0, 6, 7)), counts))
    assert (scale.low, scale.high) == (2, 4)
    even = scale_of(Bars(tuple(np.linspace(0, 6, 7)), (10,) * 6))
    assert (even.low, even.high) == (0, 6)


@pytest.mark.parametrize("value", [0.0, 0.02, 250.0])
def test_a_map_of_one_value_has_a_scale_that_holds_it(value):
    scale = scale_of(bars_of(np.full((3, 3), value)), 3)
    assert scale.low <= value <= scale.high
    assert np.isfinite(scale.place(value))


def test_a_histogram_counts_what_is_known():
    values = np.concatenate([np.linspace(0, 1, 1000), np.full(500, np.nan)])
    histogram = bars_of(values)
    assert len(histogram.edges) == 65
    assert 990 <= sum(histogram.counts) <= 1000
    assert sum(bars_of(np.full(4, np.nan)).counts) == 0


@pytest.mark.parametrize("root", [1, 3, 4])
@pytest.mark.parametrize(
    ("low", "high"), [(0.0, 1.0), (0.003, 0.4), (0.0173, 0.0996), (57.0, 122.0), (0.02, 0.021)]
)
def test_ticks_are_round_and_have_room(low, high, root):
    scale = Scale(low, high, root)
    for most in (3, 8, 16):
        ticks = scale.ticks(most)
        assert ticks == sorted(set(ticks))
        assert all(low - 1e-9 <= tick <= high + 1e-9 for tick in ticks)
        apart = np.diff(scale.place(ticks))
        assert apart.min(initial=1) >= (1 - 1e-6) / most if root > 1 and high > 2 * low else True
        assert len(ticks) <= most + 1
        assert all(len(tick_text(tick).replace(".", "").lstrip("0")) <= 4 for tick in ticks)
    assert len(scale.ticks(8)) >= 2


def test_ticks_of_an_even_scale_are_even():
    assert Scale(0.0, 2.0).ticks(8) == pytest.approx(np.arange(0, 2.1, 0.25))
    assert Scale(12.0, 47.0).ticks(4) == [20, 30, 40]


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1.0, "1"), (0.25, "0.25"), (-2.0, "−2"), (120.0, "120"), (1e-7, "1e-07"),
     (50000.0, "50000")],
)  # fmt: skip
def test_ticks_are_written_as_people_write_them(value, text):
    assert tick_text(value) == text
