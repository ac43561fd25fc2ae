"""The inverse of the Kubelka–Munk skin: the nearest colour of its surface."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse.kubelka_munk import kubelka_munk_inverse
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, from_coordinates

SKIN = KubelkaMunkSkin(ALIAGA2022)
LOW, HIGH = np.array([0.1, 0.001**0.25]), np.array([0.43 ** (1 / 3), 0.07**0.25])
"""Ends of the roots of melanin and blood."""


def rgb_of(roots):
    return SKIN.rgb(roots[..., 0] ** 3, roots[..., 1] ** 4)


@pytest.fixture(scope="module")
def inverse():
    return kubelka_munk_inverse(SKIN)


def test_colours_of_the_surface_come_back(inverse):
    roots = LOW + np.random.default_rng(2).uniform(0, 1, (5000, 2)) * (HIGH - LOW)
    truth = rgb_of(roots)
    found = inverse.nearest(truth)
    np.testing.assert_allclose(SKIN.rgb(*found.T), truth, atol=1e-7)
    np.testing.assert_allclose(found ** (1 / np.array([3, 4])), roots, atol=1e-5)
    skins = from_coordinates(inverse.encode(truth))
    assert np.allclose(skins[:, 2:], [200.0, 0.61, 0.75], rtol=1e-5)
    assert delta_e(inverse.decode(skins), truth).max() < 1e-3


def test_the_corners_come_back(inverse):
    corners = np.array([[0.001, 0.001], [0.001, 0.07], [0.43, 0.001], [0.43, 0.07]])
    np.testing.assert_allclose(inverse.nearest(SKIN.rgb(*corners.T)), corners, rtol=1e-3)
    beyond = inverse.nearest(np.array([[0.9, 0.9, 0.9], [0.0, 0.0, 0.0], [-0.1, 1.2, 0.0]]))
    assert np.all((beyond >= corners.min(0)) & (beyond <= corners.max(0)))
    np.testing.assert_allclose(beyond[:2], corners[[0, 3]], rtol=1e-12)


def test_nearest_point_on_the_surface(inverse):
    """Against brute force over a fine grid, and against SciPy's bounded least squares from there.

    Colours from everywhere, most of them far from any skin.
    """
    rng = np.random.default_rng(3)
    colours = np.concatenate([rng.uniform(0, 0.8, (150, 3)), rng.uniform(0, 0.1, (50, 3))])
    colours = colours.astype(np.float32)
    distance = np.linalg.norm(SKIN.rgb(*inverse.nearest(colours).T) - colours, axis=1)
    axes = [np.linspace(LOW[i], HIGH[i], n) for i, n in enumerate((400, 300))]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    shades = rgb_of(grid)
    for colour, ours in zip(colours, distance, strict=True):
        squares = ((shades - colour) ** 2).sum(axis=1)
        best = int(squares.argmin())
        assert ours <= np.sqrt(squares[best]) + 1e-7
        if rng.random() < 0.15:
            start = np.clip(grid[best], LOW + 1e-6, HIGH - 1e-6)
            refined = least_squares(
                lambda p, c=colour: rgb_of(p) - c, start, bounds=(LOW, HIGH), gtol=1e-12
            )
            assert ours <= np.sqrt(2 * refined.cost) + 1e-7


def test_another_skin_has_another_inverse():
    skin = KubelkaMunkSkin(ALIAGA2022, thickness=80.0, epidermis="scattering", blood=(0.001, 0.2))
    truth = skin.rgb(np.array([0.01, 0.1]), np.array([0.05, 0.15]))
    found = kubelka_munk_inverse(skin).nearest(truth)
    np.testing.assert_allclose(found, [[0.01, 0.05], [0.1, 0.15]], rtol=1e-3)


def test_as_a_model():
    model = load_model("kubelka-munk")
    colours = SKIN.rgb(np.array([[0.02, 0.1]]), np.array([[0.02, 0.03]])).astype(np.float32)
    skins = model.encode(colours)
    assert skins.shape == (1, 2, 5)
    np.testing.assert_allclose(model.decode(skins), colours, atol=1e-6)


@pytest.mark.parametrize(
    ("colours", "what"),
    [([[0.5, np.nan, 0.5]], "NaN or infinite"), ([0.5, 0.4, 0.3], r"must be \(n, 3\)")],
)
def test_bad_input_is_one_line(inverse, colours, what):
    with pytest.raises(CutisError, match=what) as caught:
        inverse.nearest(colours)
    assert "\n" not in str(caught.value)
