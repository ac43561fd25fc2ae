"""The discrete Henyey–Greenstein kernel: symmetry, conservation, moments."""

import numpy as np
import pytest

from cutis.transport.phase import henyey_greenstein
from cutis.transport.quadrature import directions

CASES = [(d, g) for d in (2, 3) for g in (-0.5, 0.0, 0.3, 0.8, 0.9)]


@pytest.mark.parametrize(("dimension", "g"), CASES)
def test_symmetric_and_conserving(dimension, g):
    nodes = directions(24, dimension)
    same, opposite = henyey_greenstein(nodes, g)
    np.testing.assert_allclose(same, same.T, rtol=1e-14)
    np.testing.assert_allclose(opposite, opposite.T, rtol=1e-14)
    root = np.sqrt(nodes.weight)
    np.testing.assert_allclose((same + opposite) @ root, root, rtol=1e-13)
    assert np.all(same > 0)
    assert np.all(opposite > 0)


@pytest.mark.parametrize(("dimension", "g"), CASES)
def test_mean_cosine_is_g(dimension, g):
    """⟨cos θ⟩ = g, projected on the normal: Σ_j p_ij μ_j (down − up) = g μ_i."""
    nodes = directions(64, dimension)
    same, opposite = henyey_greenstein(nodes, g)
    root = np.sqrt(nodes.weight)
    np.testing.assert_allclose(
        (same - opposite) @ (root * nodes.cosine) / root, g * nodes.cosine, atol=2e-7
    )


@pytest.mark.parametrize("order", [2, 3, 4])
def test_flatland_moments(order):
    """⟨cos nθ⟩ = gⁿ of the wrapped Cauchy density (shared/references/transport.md, section 3)."""
    g, nodes = 0.6, directions(64, 2)
    same, opposite = henyey_greenstein(nodes, g)
    root, wave = np.sqrt(nodes.weight), np.cos(order * np.arccos(nodes.cosine))
    mirrored = (-1) ** order * wave
    got = (same @ (root * wave) + opposite @ (root * mirrored)) / root
    np.testing.assert_allclose(got, g**order * wave, atol=1e-10)


def test_isotropic_in_both_dimensions():
    for dimension in (2, 3):
        nodes = directions(16, dimension)
        same, opposite = henyey_greenstein(nodes, 0.0)
        np.testing.assert_allclose(same, opposite, rtol=1e-14)
        np.testing.assert_allclose(
            same, 0.5 * np.sqrt(np.outer(nodes.weight, nodes.weight)), rtol=1e-12
        )
