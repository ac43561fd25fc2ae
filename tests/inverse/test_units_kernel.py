"""Compiled conversion of coordinates against the plain one."""

import numpy as np

from cutis.inverse.units_kernel import from_units, to_units
from cutis.optics import PARAMETERS, from_coordinates, to_coordinates

RNG = np.random.default_rng(2)


def test_units_of_coordinates_inside_and_beyond():
    u = RNG.uniform(-0.3, 1.3, (3000, 5)).astype(np.float32)
    u[:2] = [[0] * 5, [1] * 5]
    skins = to_units(u)
    np.testing.assert_allclose(skins, from_coordinates(u.astype(float)), rtol=2e-6)
    for i, known in enumerate(PARAMETERS):
        assert skins[:, i].min() == np.float32(known.low)
        assert skins[:, i].max() == np.float32(known.high)


def test_coordinates_of_units():
    skins = from_coordinates(RNG.random((3000, 5))).astype(np.float32)
    np.testing.assert_allclose(from_units(skins), to_coordinates(skins.astype(float)), atol=3e-7)
    assert from_units(skins[:0]).shape == (0, 5)
