"""Henyey–Greenstein scattering between the directions of a plane-parallel medium."""

import numpy as np
from numpy.typing import NDArray

from cutis.transport.quadrature import Directions


def henyey_greenstein(
    nodes: Directions, g: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Symmetrised kernels (N, N) of scattering into the same and into the opposite hemisphere.

    Entry (i, j) is √(w_i w_j) p(θ_i, θ_j), the phase function averaged over azimuth (over ±θ in
    flatland), times the size of the hemisphere. Both are scaled by one diagonal from the left
    and the right until rows and columns integrate to one, so that the discrete problem conserves
    energy and is reciprocal to rounding for any number of nodes. g = ⟨cos θ⟩ ∈ (−1, 1)
    [henyey1941; in flatland deon2016hitchhiker].
    """
    mu, sine = nodes.cosine, nodes.sine
    same = _density(np.outer(mu, mu), np.outer(sine, sine), g, nodes.dimension)
    opposite = _density(-np.outer(mu, mu), np.outer(sine, sine), g, nodes.dimension)
    scale = _balance(same + opposite, nodes.weight)
    root = np.sqrt(nodes.weight) * scale
    return root[:, None] * same * root, root[:, None] * opposite * root


def _density(
    cos_cos: NDArray[np.float64], sin_sin: NDArray[np.float64], g: float, dimension: int
) -> NDArray[np.float64]:
    """p averaged over azimuth; its mean over the whole circle or sphere is 1/2 per hemisphere."""
    a, b = 1.0 + g * g - 2.0 * g * cos_cos, 2.0 * g * sin_sin
    if dimension == 2:  # mean of the two mirror images cos(θ ∓ θ')
        return 0.5 * (1 - g * g) * 0.5 * (1 / (a - b) + 1 / (a + b))
    from scipy.special import ellipe  # mean over azimuth of (a − b cos φ)^(−3/2)

    high, low = a + np.abs(b), a - np.abs(b)
    mean = 2.0 / np.pi * ellipe(1.0 - low / high) / (low * np.sqrt(high))
    return 0.5 * (1 - g * g) * mean


def _balance(kernel: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Diagonal d with Σ_j d_i kernel_ij w_j d_j = 1 for every i (symmetric Sinkhorn scaling)."""
    d = np.ones_like(weight)
    for _ in range(1000):
        row = d * (kernel @ (weight * d))
        d /= np.sqrt(row)
        if np.abs(row - 1.0).max() < 1e-15 * len(d):
            break
    return d
