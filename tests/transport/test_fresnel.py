"""Fresnel reflectance: limits, and the averages of reference section 3."""

from itertools import pairwise

import numpy as np
import pytest

from cutis.transport import fresnel_reflectance


def cosine_average(ratio, dimension):
    """∫ F cos θ dΩ / ∫ cos θ dΩ over the hemisphere, split at the critical angle."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    ends = [0.0, np.pi / 2]
    if ratio < 1:
        ends.insert(1, np.arcsin(ratio))
    total = norm = 0.0
    for low, high in pairwise(ends):
        s = (nodes + 1) / 2
        theta = low + (high - low) * s * s * (3 - 2 * s)
        measure = weights / 2 * 6 * s * (1 - s) * (high - low) * np.cos(theta)
        measure = measure * (np.sin(theta) if dimension == 3 else 1.0)
        total += measure @ fresnel_reflectance(np.cos(theta), ratio)
        norm += measure.sum()
    return total / norm


@pytest.mark.parametrize(
    ("n", "normal", "flat_ext", "flat_int", "space_ext", "space_int"),
    [
        (1.30, 0.01701, 0.04061, 0.26201, 0.06113, 0.44446),
        (1.33, 0.02006, 0.04465, 0.28169, 0.06593, 0.47195),
        (1.40, 0.02778, 0.05416, 0.32440, 0.07681, 0.52899),
        (1.45, 0.03374, 0.06104, 0.35244, 0.08437, 0.56450),
        (1.50, 0.04000, 0.06798, 0.37865, 0.09178, 0.59635),
    ],
)
def test_lambertian_averages(n, normal, flat_ext, flat_int, space_ext, space_int):
    """shared/references/transport.md, section 3; five digits, as printed."""
    assert fresnel_reflectance(1.0, n) == pytest.approx(normal, abs=6e-6)
    assert cosine_average(n, 2) == pytest.approx(flat_ext, abs=1.5e-5)
    assert cosine_average(1 / n, 2) == pytest.approx(flat_int, abs=1.5e-5)
    assert cosine_average(n, 3) == pytest.approx(space_ext, abs=1.5e-5)
    assert cosine_average(1 / n, 3) == pytest.approx(space_int, abs=1.5e-5)
    # What enters equals what leaves, in radiance over n^(d−1): F_in = 1 − (1 − F_ext) / n^(d−1)
    for dimension in (2, 3):
        outside, inside = cosine_average(n, dimension), cosine_average(1 / n, dimension)
        assert inside == pytest.approx(1 - (1 - outside) / n ** (dimension - 1), abs=1e-7)


def test_limits():
    mu = np.linspace(0.01, 1, 50)
    np.testing.assert_allclose(fresnel_reflectance(mu, 1.0), 0, atol=1e-25)
    assert fresnel_reflectance(1.0, 1.4) == pytest.approx((0.4 / 2.4) ** 2)
    assert fresnel_reflectance(1.0, 1 / 1.4) == pytest.approx((0.4 / 2.4) ** 2)
    assert fresnel_reflectance(0.0, 1.4) == 1
    critical = np.sqrt(1 - 1 / 1.4**2)
    assert fresnel_reflectance(critical - 1e-9, 1 / 1.4) == 1
    assert fresnel_reflectance(critical + 1e-3, 1 / 1.4) < 0.9


def test_brewster_leaves_half_of_s():
    """At Brewster's angle p vanishes: F = s² / 2 with s = (n² − 1) / (n² + 1)."""
    n = 1.4
    mu = np.cos(np.arctan(n))
    assert fresnel_reflectance(mu, n) == pytest.approx(0.5 * ((n * n - 1) / (n * n + 1)) ** 2)


def test_same_from_both_sides():
    """Along one refracted path the reflectance is the same from either side."""
    mu = np.linspace(0.05, 1, 20)
    inside = np.sqrt(1 - (1 - mu**2) / 1.4**2)
    np.testing.assert_allclose(
        fresnel_reflectance(mu, 1.4), fresnel_reflectance(inside, 1 / 1.4), rtol=1e-12
    )
