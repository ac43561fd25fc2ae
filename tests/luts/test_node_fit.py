"""Nodes fitted for tetrahedra."""

import numpy as np
import OpenImageIO as oiio

from cutis.luts import write_cube
from cutis.luts.node_fit import refit, tetrahedral


def interpolated(table, places):
    nodes, weights = tetrahedral(places, len(table))
    return (weights[..., None] * table.reshape(-1, 3)[nodes]).sum(axis=1)


def function(places):
    return np.stack([np.sin(2 * p) for p in (places @ m for m in np.eye(3) + 0.5)], axis=1)


def grid(size):
    side = np.linspace(0, 1, size)
    return np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1)


def test_tetrahedra_are_opencolorios(tmp_path):
    rng = np.random.default_rng(1)
    table, places = rng.random((5, 5, 5, 3)), rng.random((400, 3))
    write_cube(tmp_path / "a.cube", table)
    image = oiio.ImageBuf(oiio.ImageSpec(400, 1, 3, "float"))
    image.set_pixels(oiio.ROI(), places[None].astype(np.float32))
    found = oiio.ImageBufAlgo.ociofiletransform(image, str(tmp_path / "a.cube"))
    np.testing.assert_allclose(
        found.get_pixels(oiio.FLOAT)[0], interpolated(table, places), atol=1e-6
    )


def test_what_tetrahedra_can_be_is_found():
    """Samples of an interpolated table lead back to it, from nodes that are off."""
    rng = np.random.default_rng(2)
    truth = rng.random((5, 5, 5, 3))
    start = truth + 0.1 * rng.standard_normal(truth.shape)
    fitted = refit(start, np.ones((5, 5, 5), bool), lambda places: interpolated(truth, places))
    inner = (slice(1, -1),) * 3  # corners have few samples to say where they are
    assert np.abs(fitted - truth)[inner].max() < 0.1 * np.abs(start - truth)[inner].max()


def test_errors_fall():
    table = function(grid(9).reshape(-1, 3)).reshape(9, 9, 9, 3)
    fitted = refit(table, np.ones((9, 9, 9), bool), function)
    places = np.random.default_rng(3).random((4000, 3))
    before, after = (np.abs(interpolated(t, places) - function(places)) for t in (table, fitted))
    assert np.percentile(after, 99) < 0.7 * np.percentile(before, 99)


def test_only_cells_that_move_are_touched():
    table = function(grid(9).reshape(-1, 3)).reshape(9, 9, 9, 3)
    moved = np.zeros((9, 9, 9), bool)
    moved[2:5, 2:5, 2:5] = True
    fitted = refit(table, moved, function)
    assert np.array_equal(fitted[~moved], table[~moved])
    assert not np.array_equal(fitted[moved], table[moved])
    assert refit(table, np.zeros_like(moved), function) is table
