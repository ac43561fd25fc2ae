"""Steps across edges that tiles share; islands that only meet there are left out."""

import numpy as np

from cutis.checks.seams import edge_step

ON = np.ones(512, np.float32)


def edge(seed=0, gain=1.0, shift=0):
    x = np.linspace(0, 12, 512) + shift
    rng = np.random.default_rng(seed)
    course = np.exp(0.2 * np.sin(x) + 0.01 * rng.standard_normal(512))
    return np.float32(gain * course[:, None] * [0.4, 0.26, 0.2]), ON


def test_edges_that_go_on_have_no_seam():
    step, share = edge_step(edge(0), edge(1), 0.05)
    assert share == 1
    assert step < 0.3


def test_a_gain_of_one_tile_is_a_seam():
    assert 2 < edge_step(edge(0), edge(1, 1.12), 0.05)[0] < 6
    assert edge_step(edge(0), edge(1, 1.02), 0.05)[0] < 1


def test_other_islands_are_left_out():
    assert edge_step(edge(0), edge(1, 1.0, shift=3), 0.05) == (0.0, 0.0)
    off = np.zeros(512, np.float32)
    assert edge_step(edge(0), (edge(1, 1.5)[0], off), 0.05) == (0.0, 0.0)


def test_tiles_of_two_sizes():
    one, other = edge(0), edge(0, 1.12)
    half = other[0].reshape(256, 2, 3).mean(axis=1), ON[:256]
    assert 2 < edge_step(one, half, 0.05)[0] < 6
