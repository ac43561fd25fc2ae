"""Subsurface inversion against the layered solver, the 3-D walk, closed forms, and itself."""

import numpy as np
import pytest
from scipy.stats import norm

from cutis.errors import CutisError
from cutis.render.inversion import diffuse_albedo, single_scattering_albedo
from cutis.transport import Layer, stack_balance, walk_stacks

MEDIA = [(0.0, 1.0), (0.0, 1.4), (0.8, 1.0), (0.8, 1.4), (-0.5, 1.0), (0.95, 1.0), (0.9, 1.5)]
LEVEL = 1e-3
"""Chance that the test against the walk fails on a right solver; fixed before its first run."""


@pytest.mark.parametrize(("g", "n"), MEDIA)
def test_inverts_the_layered_solver(g, n):
    albedo = np.concatenate([[0, 1e-4, 0.9999, 1], np.random.default_rng(1).uniform(0, 1, 12)])
    alpha = single_scattering_albedo(albedo, g, n)
    assert (alpha[[0, 3]] == [0, 1]).all()
    for wanted, a in zip(albedo[1:], alpha[1:], strict=True):
        layer = Layer(1 - a, a, g)
        found = stack_balance([layer], refractive_index=n, count=128).reflected
        assert abs(found - wanted) < 5e-6


@pytest.mark.parametrize(("g", "n"), MEDIA)
def test_round_trip(g, n):
    alpha = np.linspace(0, 1, 101)
    back = single_scattering_albedo(diffuse_albedo(alpha, g, n), g, n)
    np.testing.assert_allclose(back, alpha, atol=2e-5)
    albedo = np.linspace(0, 1, 301).reshape(43, 7)
    again = diffuse_albedo(single_scattering_albedo(albedo, g, n), g, n)
    np.testing.assert_allclose(again, albedo, atol=3e-6)


@pytest.mark.slow
@pytest.mark.parametrize("count", [6, pytest.param(24, marks=pytest.mark.long)])
def test_the_walk_in_three_dimensions_returns_the_albedo_asked_for(count):
    """Z-tests: the walk knows nothing of the solver that made the inversion."""
    rng = np.random.default_rng(7)
    photons, scores = 40_000, []
    for g, n in ((0.0, 1.0), (0.0, 1.4), (0.8, 1.0), (0.8, 1.4), (-0.4, 1.0)):
        wanted = rng.uniform(0.02, 0.95, count)
        alpha = single_scattering_albedo(wanted, g, n)
        found = walk_stacks(
            (1 - alpha)[:, None], alpha[:, None], [[g]], [[np.inf]], photons=photons,
            seed=int(100 * g + 10 * n) % 997, dimension=3, refractive_index=n,
        )  # fmt: skip
        scores.append((found.reflected - wanted) / found.reflected_error)
    z = np.abs(np.concatenate(scores)).max()
    assert z < norm.isf(LEVEL / (2 * count * 5))


def test_isotropic_albedo_of_chandrasekhar():
    """Diffuse light on an isotropic half space: 1 − 2 √(1 − α) ∫ H(μ) μ dμ [chandrasekhar1960].

    H solves 1/H(μ) = √(1 − α) + α/2 ∫ μ' H(μ') / (μ + μ') dμ', here by iteration.
    """
    x, w = np.polynomial.legendre.leggauss(64)
    x, w = 0.5 * (x + 1), 0.5 * w
    for alpha in (0.1, 0.5, 0.9, 0.99):
        h = np.ones_like(x)
        for _ in range(400):
            h = 1 / (
                np.sqrt(1 - alpha) + 0.5 * alpha * (w * x * h / (x[:, None] + x)) @ np.ones(64)
            )
        closed = 1 - 2 * np.sqrt(1 - alpha) * np.sum(w * x * h)
        assert abs(diffuse_albedo(alpha) - closed) < 1e-6


def test_darker_when_less_is_scattered_or_light_is_thrown_back():
    albedo = np.linspace(0.05, 0.95, 10)
    matched, glossy = (single_scattering_albedo(albedo, 0.0, n) for n in (1.0, 1.4))
    forward = single_scattering_albedo(albedo, 0.8)
    assert (np.diff(matched) > 0).all()
    assert (glossy > matched).all()  # internal reflection gives absorption more chances
    assert (forward > matched).all()


def test_single_precision_stays():
    albedo = np.random.default_rng(3).uniform(0, 1, (5, 4, 3)).astype(np.float32)
    alpha = single_scattering_albedo(albedo)
    assert alpha.dtype == np.float32
    np.testing.assert_allclose(alpha, single_scattering_albedo(albedo.astype(float)), atol=1e-6)


@pytest.mark.parametrize("bad", [np.nan, -0.1, 1.1, np.inf])
def test_values_that_are_no_albedo_are_refused(bad):
    for function in (diffuse_albedo, single_scattering_albedo):
        with pytest.raises(CutisError, match="1 values"):
            function([0.5, bad])


def test_media_out_of_range_are_refused():
    with pytest.raises(CutisError, match="anisotropy"):
        single_scattering_albedo(0.5, 0.99)
    with pytest.raises(CutisError, match="refractive"):
        single_scattering_albedo(0.5, 0.0, 0.5)
