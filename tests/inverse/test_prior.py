"""The prior of measured skin: its most probable skins against a plain minimisation."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.colour import delta_e
from cutis.inverse.prior import DARK, TOLERANCE, SkinPrior, load_prior, save_prior, unit_slopes
from cutis.inverse.shipped import shipped_prior
from cutis.optics import MEASURED2026, from_coordinates

RNG = np.random.default_rng(6)


@pytest.fixture(scope="module")
def prior() -> SkinPrior:
    return shipped_prior()


@pytest.fixture(scope="module")
def space() -> AlbedoSpace:
    return albedo_space(MEASURED2026)


def colours(prior: SkinPrior, count: int, spread: float = 0.6) -> np.ndarray:
    """(n, 3) albedo about the middle of measured skin."""
    whitened = spread * RNG.standard_normal((count, 3))
    return (
        (np.exp(whitened @ np.linalg.inv(prior.whitening).T + prior.centre) - DARK)
        .clip(0.002)
        .astype(np.float32)
    )


def residual(prior: SkinPrior, space: AlbedoSpace, colour: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(8,) whose squares the most probable skin minimises, by the formula of the module."""
    rgb = space.rgb(from_coordinates(1 / (1 + np.exp(-z)))).astype(float)
    scale = TOLERANCE * (colour.mean() + 0.01) ** (2 / 3)
    expected = np.clip(prior.features(colour[None])[0] @ prior.means, -6, 6)
    root = np.linalg.cholesky(prior.precision)
    return np.concatenate([(rgb - colour) / scale, root.T @ (z - expected)])


def test_most_probable_skins_are_the_lowest(prior, space):
    rgb = colours(prior, 6)
    found = prior.skins(space, rgb).astype(float)
    for colour, u in zip(rgb.astype(float), found, strict=True):
        z = np.log(u / (1 - u))
        here = (residual(prior, space, colour, z) ** 2).sum()
        others = [
            least_squares(
                lambda at, colour=colour: residual(prior, space, colour, at), start, diff_step=1e-3
            )
            for start in z + 0.5 * RNG.standard_normal((3, 5))
        ]
        assert here < 2 * min(other.cost for other in others) + 0.05  # of σ²; cost is half of it


def test_they_have_the_colour(prior, space):
    rgb = colours(prior, 300)
    error = delta_e(space.rgb(from_coordinates(prior.skins(space, rgb))), rgb)
    assert np.median(error) < 0.02
    assert np.percentile(error, 95) < 0.1


def test_expectation_stays_at_the_edge_of_measured_colours(prior):
    far = (np.exp(prior.centre + np.array([3.0, -1.0, 4.0])) - DARK)[None]
    terms = prior.features(far)
    np.testing.assert_allclose(np.linalg.norm(terms[0, 1:4]), prior.radius[0], rtol=0.02)
    farther = (np.exp(prior.centre + 2 * np.array([3.0, -1.0, 4.0])) - DARK)[None]
    np.testing.assert_allclose(prior.expected(farther), prior.expected(far), atol=0.02)


def test_likeness_falls_away_from_measured_colours(prior):
    middle = (np.exp(prior.centre) - DARK)[None]
    assert prior.likeness(middle)[0] == pytest.approx(1)
    odd = np.array([[0.05, 0.05, 0.9], [0.0, 0.6, 0.0], [0.1, 0.1, 0.1]])
    assert prior.likeness(odd).max() < 0.1


def test_nothing_is_known_of_what_is_no_skin(prior, space):
    odd = np.array([[0.05, 0.05, 0.9], [0.9, 0.9, 0.9]], np.float32)
    sigma, confidence = prior.trust(space, odd, prior.skins(space, odd))
    assert confidence.max() < 0.01
    assert np.all(sigma >= 0.99 * prior.prior_sigma)


def test_a_colour_tells_of_melanin_more_than_of_its_kind(prior, space):
    rgb = colours(prior, 200)
    sigma, confidence = prior.trust(space, rgb, prior.skins(space, rgb))
    told = 1 - np.median(sigma, axis=0) / prior.prior_sigma
    assert told[0] > told[3]
    assert np.median(confidence) > 0.9


def test_darker_skin_hides_its_dermis(prior, space):
    """σ of blood grows with melanin: light does not come back from below."""
    light, dark = (
        (np.exp(prior.centre + shift) - DARK)[None].astype(np.float32) for shift in (0.5, -1.2)
    )
    blood = [prior.trust(space, rgb, prior.skins(space, rgb))[0][0, 1] for rgb in (light, dark)]
    assert blood[1] > 1.5 * blood[0]


def test_unit_slopes_are_derivatives():
    u = RNG.uniform(0.1, 0.9, (20, 5))
    step = 1e-5
    for i in range(5):
        shift = step * np.eye(5)[i]
        rise = (from_coordinates(u + shift) - from_coordinates(u - shift))[:, i] / (2 * step)
        np.testing.assert_allclose(unit_slopes(u)[:, i], rise, rtol=1e-6)


def test_round_trip(prior, tmp_path):
    save_prior(prior, tmp_path / "again.npz")
    again = load_prior(tmp_path / "again.npz")
    for name, values in vars(prior).items():
        np.testing.assert_array_equal(getattr(again, name), values)
