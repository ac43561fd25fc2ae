"""The fit of one skin per colour against SciPy, at the edges of the gamut and past them."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial import KDTree

from cutis.albedo import albedo_space, uniform
from cutis.colour import delta_e, is_skin_colour
from cutis.errors import CutisError
from cutis.inverse.fit import explain, fit, logistic, logit
from cutis.optics import ALIAGA2022, GITLINA2020, from_coordinates

CENTRE = np.array([0.4, 0.5, 0.4, 0.5, 0.6])
PRECISION = np.diag([0.5, 0.8, 2.0, 1.5, 1.0])
TOLERANCE = 0.003


def skins(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.1, 0.9, (count, 5))


def cost(u: np.ndarray, colour: np.ndarray) -> float:
    """The function that `fit.py` states, in double precision but for the albedo space."""
    residual = albedo_space(ALIAGA2022).rgb(from_coordinates(u)).astype(np.float64) - colour
    scale = TOLERANCE * (colour.mean() + 0.01) ** (2 / 3)
    z = np.log(u / (1 - u)) - np.log(CENTRE / (1 - CENTRE))
    return float(np.sum((residual / scale) ** 2) + z @ PRECISION @ z)


def test_logit_and_logistic_are_inverse():
    u = np.linspace(0.001, 0.999, 50, dtype=np.float32)
    np.testing.assert_allclose(logistic(logit(u)), u, atol=1e-6)
    assert np.isfinite(logit([0.0, 1.0])).all()


def test_colours_of_skins_are_explained():
    space = albedo_space(ALIAGA2022)
    colours = space.rgb(from_coordinates(skins(300)))
    found = space.rgb(from_coordinates(fit(space, colours, CENTRE, PRECISION, TOLERANCE)))
    errors = delta_e(found, colours)
    assert errors.mean() < 0.2
    assert np.percentile(errors, 95) < 0.6


def test_no_worse_than_a_general_solver():
    space = albedo_space(ALIAGA2022)
    colours = space.rgb(from_coordinates(skins(8, seed=4))).astype(np.float64)
    ours = fit(space, colours, CENTRE, PRECISION, TOLERANCE, iterations=60).astype(np.float64)
    root = np.sqrt(PRECISION)
    start = np.log(CENTRE / (1 - CENTRE))
    for u, colour in zip(ours, colours, strict=True):
        scale = TOLERANCE * (colour.mean() + 0.01) ** (2 / 3)

        def residuals(z, colour=colour, scale=scale):
            rgb = space.rgb(from_coordinates(1 / (1 + np.exp(-z)))).astype(np.float64)
            return np.concatenate([(rgb - colour) / scale, root @ (z - start)])

        best = least_squares(residuals, start, diff_step=1e-3)
        theirs = 2 * best.cost
        assert cost(u, colour) <= 1.02 * theirs + 0.02


def test_optimum_is_flat():
    """Small moves in any direction do not lower the cost."""
    space = albedo_space(ALIAGA2022)
    colours = space.rgb(from_coordinates(skins(5, seed=9))).astype(np.float64)
    found = fit(space, colours, CENTRE, PRECISION, TOLERANCE, iterations=60).astype(np.float64)
    rng = np.random.default_rng(2)
    for u, colour in zip(found, colours, strict=True):
        here = cost(u, colour)
        for move in rng.standard_normal((20, 5)):
            z = np.log(u / (1 - u)) + 0.03 * move / np.linalg.norm(move)
            assert cost(1 / (1 + np.exp(-z)), colour) > here - 0.02


@pytest.mark.parametrize(
    "colour",
    [(0, 0, 0), (1, 1, 1), (0, 0, 1), (0, 1, 0), (5, 4, 3), (-0.2, 0.3, 0.1), (1e6, 1e6, 1e6)],
)
def test_absurd_colours_stay_in_range(colour):
    u = fit(albedo_space(ALIAGA2022), np.array([colour]), CENTRE, PRECISION, TOLERANCE)
    assert np.isfinite(u).all()
    assert u.min() > 0
    assert u.max() < 1


def test_each_colour_may_have_its_own_centre():
    space = albedo_space(ALIAGA2022)
    colours = space.rgb(from_coordinates(skins(4)))
    centres = np.tile(CENTRE, (4, 1))
    np.testing.assert_array_equal(
        fit(space, colours, centres, PRECISION, TOLERANCE),
        fit(space, colours, CENTRE, PRECISION, TOLERANCE),
    )


def test_explain_finds_the_nearest_skin_of_a_tissue():
    """Against 300 000 skins of the tissue, spread evenly, for colours in and out of its gamut."""
    colours = albedo_space(ALIAGA2022).rgb(uniform(3000, 3))
    face = colours[is_skin_colour(colours)][:1200].reshape(30, 40, 3)
    maps, model = explain(face, GITLINA2020)
    space = albedo_space(GITLINA2020)
    assert list(maps) == ["melanin", "blood", "eumelanin", "epidermal_blood"]
    for known in GITLINA2020.parameters:
        assert maps[known.name].shape == (30, 40)
        assert known.low <= maps[known.name].min() <= maps[known.name].max() <= known.high
    np.testing.assert_allclose(space.rgb(np.stack(list(maps.values()), -1)), model, atol=1e-6)
    u = np.random.default_rng(11).random((300_000, 4))
    every = [p.from_coordinate(u[:, i]) for i, p in enumerate(GITLINA2020.parameters)]
    nearest = KDTree(space.rgb(np.stack(every, -1))).query(face)[0]
    ours = np.linalg.norm(model - face, axis=-1)
    assert np.mean(ours > 0.03) > 0.05  # far out of gamut
    assert np.mean(ours < nearest + 2e-3) > 0.95
    assert np.mean(ours**2) < 1.05 * np.mean(np.minimum(ours, nearest) ** 2)


@pytest.mark.parametrize(
    ("rgb", "what"), [(np.zeros((4, 4)), "linear sRGB"), ([0.5, np.nan, 0.2], "not finite")]
)
def test_what_cannot_be_explained(rgb, what):
    with pytest.raises(CutisError, match=what):
        explain(rgb, ALIAGA2022)
