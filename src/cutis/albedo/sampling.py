"""Skins spread over the albedo space, in network coordinates."""

import numpy as np
from numpy.typing import NDArray

from cutis.optics import from_coordinates


def halton(count: int, seed: int = 0) -> NDArray[np.floating]:
    """(count, 5) parameters, a scrambled Halton sequence in coordinates [halton1964]."""
    from scipy.stats import qmc

    return from_coordinates(qmc.Halton(5, scramble=True, rng=seed).random(count))


def uniform(count: int, seed: int = 0) -> NDArray[np.floating]:
    """(count, 5) parameters, independent and uniform in coordinates."""
    return from_coordinates(np.random.default_rng(seed).random((count, 5)))
