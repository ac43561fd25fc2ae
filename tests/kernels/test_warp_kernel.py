"""Compiled conversion of coordinates against the plain one."""

import numpy as np
import pytest

from cutis.kernels import warp
from cutis.kernels.compiling import compiled
from cutis.kernels.warp_kernel import slope_of, to_coordinates, to_units
from cutis.optics import PARAMETERS, axes, from_coordinates
from cutis.optics import to_coordinates as plain

RNG = np.random.default_rng(2)
AXES = axes().astype(np.float32)
ENDS = [(0.1, 2.0, root) for root in (1, 2, 3, 4)]


@compiled()
def slopes(u, axes, out):
    for i in range(len(u)):
        for p in range(out.shape[1]):
            out[i, p] = slope_of(u[i], axes, p)


def test_units_of_coordinates_inside_and_beyond():
    u = RNG.uniform(-0.3, 1.3, (3000, 5)).astype(np.float32)
    u[:2] = [[0] * 5, [1] * 5]
    skins = to_units(u, AXES)
    np.testing.assert_allclose(skins, from_coordinates(u.astype(float)), rtol=2e-6)
    for i, known in enumerate(PARAMETERS):
        assert skins[:, i].min() == np.float32(known.low)
        assert skins[:, i].max() == np.float32(known.high)


def test_coordinates_of_units():
    skins = from_coordinates(RNG.random((3000, 5))).astype(np.float32)
    np.testing.assert_allclose(to_coordinates(skins, AXES), plain(skins.astype(float)), atol=3e-7)
    assert to_coordinates(skins[:0], AXES).shape == (0, 5)


def test_every_root_there_and_back_and_its_slope():
    table = warp.axes(*zip(*ENDS, strict=True)).astype(np.float32)
    u = RNG.random((500, 4)).astype(np.float32)
    values = to_units(u, table)
    np.testing.assert_allclose(to_coordinates(values, table), u, atol=1e-5)
    found = np.empty((500, 4))
    slopes(u[:, 0], table, found)
    for p, ends in enumerate(ENDS):
        np.testing.assert_allclose(values[:, p], warp.from_coordinate(u[:, p], *ends), rtol=2e-6)
        np.testing.assert_allclose(found[:, p], warp.slope(u[:, 0], *ends), rtol=2e-6)


def test_slopes_are_differences():
    u, step = RNG.random(100), 1e-6
    for ends in ENDS:
        rise = (warp.from_coordinate(u + step, *ends) - warp.from_coordinate(u, *ends)) / step
        inside = u < 1 - step
        np.testing.assert_allclose(rise[inside], warp.slope(u, *ends)[inside], rtol=1e-4)


def test_what_is_held_stays():
    table = axes(held={"thickness": 60.0, "blood": 0.05}).astype(np.float32)
    found = to_units(RNG.random((9, 5)).astype(np.float32), table)
    np.testing.assert_allclose(found[:, 1:3], [[0.05, 60.0]] * 9, rtol=1e-6)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(found[:, 0], found[0, 0])
