"""The look-up tensor against brute force, and what it does to skins."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, grid_skins
from cutis.errors import CutisError
from cutis.inverse.lookup import (
    SHAPES,
    LookupTensor,
    build_tensor,
    lookup_tensor,
    tensor_of_spectra,
)
from cutis.kernels.nearest import curve_order
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, PARAMETERS, to_coordinates

SMALL = (16, 12, 3, 2, 2)


def brute_force(points, queries):
    """Index of the nearest point, the lowest of equals: every distance, in double precision."""
    result = np.empty(len(queries), dtype=np.int64)
    for i, query in enumerate(queries.astype(np.float64)):
        dx, dy, dz = (query - points.astype(np.float64)).T
        result[i] = np.argmin(dx * dx + dy * dy + dz * dz)
    return result


@pytest.fixture(scope="module")
def small():
    return build_tensor(SMALL, albedo_space(ALIAGA2022))


@pytest.mark.parametrize("where", ["gamut", "cube", "far", "nodes", "grey", "one"])
def test_nearest_is_that_of_brute_force(small, where):
    rng = np.random.default_rng(3)
    queries = {
        "gamut": small.colours[rng.integers(0, len(small.colours), 3000)]
        * (1 + 0.01 * rng.standard_normal((3000, 3))),
        "cube": rng.random((3000, 3)),
        "far": rng.normal(0, 20, (2000, 3)),
        "nodes": small.colours[::3],
        "grey": np.repeat(rng.random((1500, 1)), 3, axis=1),
        "one": np.full((3, 3), 0.2),
    }[where].astype(np.float32)
    assert np.array_equal(small.nearest(queries), brute_force(small.colours, queries))


def test_the_large_tensor_too():
    tensor = lookup_tensor("lookup")
    assert tensor.colours.shape == (256_000, 3)
    rng = np.random.default_rng(4)
    queries = np.concatenate(
        [rng.random((150, 3)), tensor.colours[rng.integers(0, 256_000, 150)] + 0.003]
    ).astype(np.float32)
    assert np.array_equal(tensor.nearest(queries), brute_force(tensor.colours, queries))


def test_the_first_of_equals_wins():
    colours = np.zeros((len(grid_skins(SMALL)), 3), dtype=np.float32)
    colours[700:] = 1.0
    tensor = LookupTensor(SMALL, colours)
    queries = np.array([[0.1, 0.1, 0.1], [0.9, 0.9, 0.9], [0.5, 0.5, 0.5]], dtype=np.float32)
    assert tensor.nearest(queries).tolist() == [0, 700, 0]


def test_no_queries_no_answers(small):
    assert small.nearest(np.empty((0, 3))).shape == (0,)
    assert curve_order(np.empty((0, 3), dtype=np.float32)).shape == (0,)


def test_nodes_come_back(small):
    """Every node decodes to its own colour, and its colour encodes to a skin of that colour."""
    assert np.array_equal(small.decode(small.skins), small.colours)
    again = small.colours[small.nearest(small.colours)]
    assert np.array_equal(again, small.colours)


def test_edits_are_quantised(small):
    """A skin off the grid takes the colour of the nearest node, and steps there."""
    skins = np.repeat(small.skins[1234:1235], 50, axis=0)
    skins[:, 0] = np.linspace(0.02, 0.2, 50)
    colours = small.decode(skins)
    steps = np.abs(np.diff(colours, axis=0)).max(axis=1)
    assert 0 < np.count_nonzero(steps) < 10
    u = to_coordinates(skins)
    nodes = np.stack([np.rint(u[:, i] * (n - 1)) for i, n in enumerate(SMALL)], -1).astype(int)
    assert np.array_equal(colours, small.colours[np.ravel_multi_index(tuple(nodes.T), SMALL)])


def test_grid_spans_the_ranges():
    skins = grid_skins(SHAPES["lookup-55k"])
    assert skins.shape == (55_296, 5)
    for i, known in enumerate(PARAMETERS):
        assert np.isclose(skins[:, i].min(), known.low)
        assert np.isclose(skins[:, i].max(), known.high)
    u = to_coordinates(skins.reshape(64, 32, 3, 3, 3, 5))
    assert np.allclose(np.diff(u[:, 0, 0, 0, 0, 0]), 1 / 63)
    assert grid_skins((1, 1, 1, 1, 1)).shape == (1, 5)


def test_a_tensor_of_simulated_spectra():
    skins = grid_skins(SMALL)
    tensor = tensor_of_spectra(SMALL, albedo_space(ALIAGA2022).reflectance(skins))
    assert np.allclose(
        tensor.colours, build_tensor(SMALL, albedo_space(ALIAGA2022)).colours, atol=2e-6
    )


@pytest.mark.parametrize("name", ["lookup", "lookup-55k"])
def test_as_a_model(name):
    model = load_model(name)
    rgb = albedo_space(ALIAGA2022).rgb(
        np.array([[0.02, 0.02, 80.0, 0.7, 0.7], [0.2, 0.03, 60, 0.9, 0.5]])
    )
    error = np.abs(model.decode(model.encode(rgb)) - rgb).max()
    assert error < {"lookup": 0.01, "lookup-55k": 0.02}[name]


@pytest.mark.parametrize(
    "shape",
    [(), (4, 4), (4, 4, 2, 2, 2, 2), (4, 4, 0, 2, 2), (4, 4, -1, 2, 2), (4, 4, 2.5, 2, 2),
     (4, 4, np.nan, 2, 2), (np.inf, 4, 2, 2, 2), ("a", 4, 2, 2, 2), 5, None],
)  # fmt: skip
def test_shapes_that_are_none(shape):
    for build in (
        lambda s: build_tensor(s, albedo_space(ALIAGA2022)),
        lambda s: tensor_of_spectra(s, np.ones((2, 41))),
    ):
        with pytest.raises(CutisError, match="five whole numbers above zero") as caught:
            build(shape)
        assert "\n" not in str(caught.value)


def test_skins_out_of_range_are_those_of_its_end(small):
    beyond = np.array([[5.0, -0.1, 500.0, 2.0, -1.0], [-1.0, 7.0, -3.0, -2.0, 1.5]])
    ends = np.array([[p.low, p.high] for p in PARAMETERS]).T
    at_end = [[ends[k][i] for i, k in enumerate(row)] for row in ([1, 0, 1, 1, 0], [0, 1, 0, 0, 1])]
    assert np.array_equal(small.decode(beyond), small.decode(np.array(at_end)))
    with pytest.raises(CutisError, match="NaN"):
        small.decode(beyond * np.nan)


def test_colours_as_far_as_float32_goes(small):
    queries = np.array([[3e38, -3e38, 0], [-3e38, 3e38, 3e38], [1e-45, 0, 0]], dtype=np.float32)
    assert np.array_equal(small.nearest(queries), brute_force(small.colours, queries))
    with pytest.raises(CutisError, match="infinite"):
        small.nearest([[1e39, 0, 0]])


def test_bad_colours(small):
    with pytest.raises(CutisError, match="NaN"):
        small.nearest([[np.nan, 0, 0]])
    with pytest.raises(CutisError, match=r"\(n, 3\)"):
        small.nearest([0.1, 0.2, 0.3])
    with pytest.raises(CutisError, match="as many"):
        LookupTensor(SMALL, np.zeros((3, 3), np.float32))
    with pytest.raises(CutisError, match="reflectance"):
        tensor_of_spectra(SMALL, np.zeros((3, 3)))
