"""The Kubelka–Munk skin and its inverse."""

import numpy as np
import pytest

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.colour import delta_e
from cutis.inverse import load_model
from cutis.inverse.kubelka_munk import kubelka_munk_inverse
from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates

SKIN = KubelkaMunkSkin()


def test_reflectance_by_hand_at_550_nm():
    """exp(−2 μa,e t) R∞ with the tissue's own coefficients, K = 2 μa, S = ¾ μs′."""
    i = int(np.flatnonzero(WAVELENGTHS == 550)[0])
    epidermis = ALIAGA2022.epidermis_absorption(0.05, 0.61, 550.0).item()
    dermis = ALIAGA2022.dermis_absorption(0.02, 0.75, 550.0).item()
    ratio = 2 * dermis / (0.75 * float(ALIAGA2022.reduced_scattering(550.0)))
    expected = np.exp(-2 * epidermis * 0.02) * (1 + ratio - np.sqrt(ratio**2 + 2 * ratio))
    assert SKIN.reflectance(0.05, 0.02)[i] == pytest.approx(expected, rel=1e-12)


def test_more_of_either_is_darker():
    axis = np.linspace(0.002, 0.07, 30)
    assert np.all(np.diff(SKIN.reflectance(axis, 0.02), axis=0) < 0)
    assert np.all(np.diff(SKIN.reflectance(0.02, axis)[:, 2:30], axis=0) < 0)
    assert SKIN.rgb(0.02, 0.07)[1] < SKIN.rgb(0.02, 0.01)[1]


@pytest.fixture(scope="module")
def inverse():
    return kubelka_munk_inverse()


def test_skins_come_back(inverse):
    rng = np.random.default_rng(2)
    melanin = rng.uniform(0.12, 0.74, 2000) ** 3
    blood = rng.uniform(0.2, 0.51, 2000) ** 4
    colours = SKIN.rgb(melanin, blood).astype(np.float32)
    skins = from_coordinates(inverse.encode(colours))
    error = delta_e(inverse.decode(skins), colours)
    assert np.percentile(error, 90) < 0.1
    assert error.max() < 0.5  # of nearly black skins, in whose colour the two hardly differ
    light = melanin < 0.1
    np.testing.assert_allclose(skins[light, 0], melanin[light], rtol=4e-2)
    assert np.allclose(skins[:, 2:], [200.0, 0.61, 0.75], rtol=1e-5)


def test_nearest_point_on_the_surface(inverse):
    """Against brute force over a fine grid: no point of it is nearer than what was found."""
    rng = np.random.default_rng(3)
    colours = rng.uniform(0.02, 0.8, (300, 3)).astype(np.float32)
    found = inverse.decode(from_coordinates(inverse.encode(colours)).astype(np.float32))
    melanin = np.linspace(0.001 ** (1 / 3), 0.43 ** (1 / 3), 700) ** 3
    blood = np.linspace(0.001**0.25, 0.07**0.25, 500) ** 4
    grid = SKIN.rgb(*np.meshgrid(melanin, blood, indexing="ij")).reshape(-1, 3)
    for colour, ours in zip(colours, found, strict=True):
        best = np.sqrt(((grid - colour) ** 2).sum(axis=1).min())
        assert np.linalg.norm(ours - colour) < best + 5e-4


def test_as_a_model():
    model = load_model("kubelka-munk")
    colours = SKIN.rgb(np.array([0.02, 0.1]), np.array([0.02, 0.03])).astype(np.float32)
    np.testing.assert_allclose(model.decode(model.encode(colours)), colours, atol=1e-4)
