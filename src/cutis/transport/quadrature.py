"""Directions of the discrete-ordinates method, in flatland (2) and in space (3 dimensions)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError


@dataclass(frozen=True)
class Directions:
    """Downward directions of a plane-parallel medium; the upward ones are their mirror images.

    `cosine` (N,) is μ = cos θ to the normal, `weight` (N,) the share of solid angle (planar angle
    in flatland) of each node, Σ weight = 1 over the hemisphere; `dimension` is 2 or 3.
    """

    cosine: NDArray[np.float64]
    weight: NDArray[np.float64]
    dimension: int

    @property
    def sine(self) -> NDArray[np.float64]:
        """(N,) sin θ."""
        return np.sqrt(np.maximum(1.0 - self.cosine**2, 0.0))

    @property
    def flux(self) -> NDArray[np.float64]:
        """(N,) √(weight · μ): radiance × flux is the symmetrised unknown of the solver."""
        return np.sqrt(self.weight * self.cosine)


BEAM_WEIGHT = 1e-8
"""Solid angle of the node that lets a beam in: it perturbs the rest by as much."""


def directions(
    count: int, dimension: int, refractive_index: float = 1.0, beam: float | None = None
) -> Directions:
    """Gauss–Legendre nodes in θ on [0, π/2], `count` in all.

    Inside a medium of `refractive_index` > 1 they are divided at the critical angle; the half
    below it is spaced evenly in the angle of refraction, in which the Fresnel reflectance is
    smooth. `beam` (a cosine) adds a node of weight BEAM_WEIGHT in that direction, by which a
    collimated beam can be let in. Nodes in θ crowd towards grazing, where radiance varies
    fastest, so the error falls spectrally (docs/transport.md).
    """
    check_medium(count, dimension, refractive_index)
    if refractive_index > 1.0:
        outside, outside_weight = _gauss(count // 2, 0.0, np.pi / 2)
        escaping = np.arcsin(np.sin(outside) / refractive_index)
        escaping_weight = outside_weight * np.cos(outside) / (refractive_index * np.cos(escaping))
        trapped, trapped_weight = _gauss(
            count - count // 2, float(np.arcsin(1.0 / refractive_index)), np.pi / 2
        )
        theta = np.concatenate([escaping, trapped])
        weight = np.concatenate([escaping_weight, trapped_weight])
    else:
        theta, weight = _gauss(count, 0.0, np.pi / 2)
    if dimension == 3:
        weight = weight * np.sin(theta)
    weight, cosine = weight / weight.sum(), np.cos(theta)
    if beam is not None:
        cosine, weight = np.append(cosine, beam), np.append(weight, BEAM_WEIGHT)
    return Directions(cosine, weight, dimension)


def _gauss(count: int, low: float, high: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return low + (nodes + 1) * (high - low) / 2, weights * (high - low) / 2


def check_medium(count: int, dimension: int, refractive_index: float) -> None:
    """Raises CutisError unless directions can be made of these."""
    if dimension not in (2, 3):
        raise CutisError(f"dimension = {dimension}: it must be 2 (flatland) or 3")
    if not (np.isfinite(refractive_index) and refractive_index > 0):
        raise CutisError(f"refractive_index = {refractive_index}: it must be a positive number")
    if count < 2:
        raise CutisError(f"count = {count}: at least 2 directions per hemisphere are needed")


def beam_cosine(incidence: float | str) -> float | None:
    """Cosine in (0, 1] of a beam, None for "lambertian"; raises CutisError for anything else."""
    if incidence == "lambertian":
        return None
    if isinstance(incidence, str) or not 0 < incidence <= 1:
        raise CutisError(
            f"incidence = {incidence!r}: it must be 'lambertian' or the cosine of a beam, "
            "above 0 and at most 1"
        )
    return float(incidence)
