"""Percentiles and bars from histograms, against NumPy on the values themselves."""

import numpy as np
import pytest

from cutis.albedo import halton
from cutis.maps.statistics import BINS, SHOWN, Histogram, MapStatistics, coordinates
from cutis.optics import NAMES, PARAMETERS, to_coordinates

SKINS = halton(4000, 5).astype(np.float32).reshape(50, 80, 5)
INSIDE = np.random.default_rng(1).random((50, 80)) < 0.7


def maps():
    return [np.ascontiguousarray(SKINS[..., i]) for i in range(5)]


def test_coordinates_are_those_of_optics():
    u = coordinates(maps(), INSIDE)
    np.testing.assert_allclose(u[INSIDE], to_coordinates(SKINS[INSIDE]), atol=2e-6)
    assert not u[~INSIDE].any()


@pytest.mark.parametrize("rows", [50, 7, 1])
def test_percentiles(rows):
    found = MapStatistics()
    for top in range(0, 50, rows):
        part = slice(top, top + rows)
        found.add(coordinates([m[part] for m in maps()], INSIDE[part]), INSIDE[part])
    for i, (name, values) in enumerate(found.percentiles((0.1, 0.5, 0.99)).items()):
        assert name == NAMES[i]
        to_u = PARAMETERS[i].to_coordinate
        expected = np.percentile(SKINS[INSIDE][:, i], [10, 50, 99], method="inverted_cdf")
        np.testing.assert_allclose(to_u(np.array(values)), to_u(expected), atol=1.2 / BINS)


def test_bars_hold_what_lies_between_their_ends():
    found = MapStatistics()
    found.add(coordinates(maps(), INSIDE), INSIDE)
    for i, bars in enumerate(found.histograms().values()):
        values = SKINS[INSIDE][:, i]
        assert len(bars["counts"]) == SHOWN == len(bars["edges"]) - 1
        counts, _ = np.histogram(values, bars["edges"])
        assert np.abs(counts - bars["counts"]).sum() <= 0.01 * len(values)
        assert sum(bars["counts"]) >= 0.99 * len(values)
        steps = np.diff(PARAMETERS[i].to_coordinate(np.array(bars["edges"])))
        np.testing.assert_allclose(steps[:-1], steps[0], rtol=2e-2)


def test_a_map_that_is_flat():
    found = MapStatistics()
    ones = np.ones((2, 3), bool)
    found.add(coordinates([np.full((2, 3), p.low, np.float32) for p in PARAMETERS], ones), ones)
    assert set(found.clamped().values()) == {1.0}
    for name, bars in found.histograms().items():
        assert sum(bars["counts"]) == 6, name


def test_numbers():
    values = np.random.default_rng(2).normal(3, 2, 5000).astype(np.float32)
    found = Histogram(-10, 20)
    found.add(values[:10])
    found.add(values[10:])
    assert found.count == 5000
    assert found.mean() == pytest.approx(values.mean(dtype=float))
    expected = np.percentile(values, 95, method="inverted_cdf")
    assert found.percentile(0.95) == pytest.approx(expected, abs=30 / BINS)
