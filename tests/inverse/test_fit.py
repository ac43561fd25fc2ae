"""The fit of one skin per colour against SciPy, at the edges of the gamut and past them."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from cutis.albedo import albedo_space
from cutis.colour import delta_e
from cutis.inverse.fit import fit, logistic, logit
from cutis.optics import from_coordinates

CENTRE = np.array([0.4, 0.5, 0.4, 0.5, 0.6])
PRECISION = np.diag([0.5, 0.8, 2.0, 1.5, 1.0])
TOLERANCE = 0.003


def skins(count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.1, 0.9, (count, 5))


def cost(u: np.ndarray, colour: np.ndarray) -> float:
    """The function that `fit.py` states, in double precision but for the albedo space."""
    residual = albedo_space().rgb(from_coordinates(u)).astype(np.float64) - colour
    scale = TOLERANCE * (colour.mean() + 0.01) ** (2 / 3)
    z = np.log(u / (1 - u)) - np.log(CENTRE / (1 - CENTRE))
    return float(np.sum((residual / scale) ** 2) + z @ PRECISION @ z)


def test_logit_and_logistic_are_inverse():
    u = np.linspace(0.001, 0.999, 50, dtype=np.float32)
    np.testing.assert_allclose(logistic(logit(u)), u, atol=1e-6)
    assert np.isfinite(logit([0.0, 1.0])).all()


def test_colours_of_skins_are_explained():
    space = albedo_space()
    colours = space.rgb(from_coordinates(skins(300)))
    found = space.rgb(from_coordinates(fit(space, colours, CENTRE, PRECISION, TOLERANCE)))
    errors = delta_e(found, colours)
    assert errors.mean() < 0.2
    assert np.percentile(errors, 95) < 0.6


def test_no_worse_than_a_general_solver():
    space = albedo_space()
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
    space = albedo_space()
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
    u = fit(albedo_space(), np.array([colour]), CENTRE, PRECISION, TOLERANCE)
    assert np.isfinite(u).all()
    assert u.min() > 0
    assert u.max() < 1


def test_each_colour_may_have_its_own_centre():
    space = albedo_space()
    colours = space.rgb(from_coordinates(skins(4)))
    centres = np.tile(CENTRE, (4, 1))
    np.testing.assert_array_equal(
        fit(space, colours, centres, PRECISION, TOLERANCE),
        fit(space, colours, CENTRE, PRECISION, TOLERANCE),
    )
