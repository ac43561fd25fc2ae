"""An independent walk through two layers against the exact solver, by the walk's own error."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.stats import chi2, norm

from cutis.optics import ALIAGA2022, WAVELENGTHS, from_coordinates
from cutis.transport import two_layer_albedo

PHOTONS = 100_000
"""Per skin."""
LEVEL = 1e-3
"""Chance that a right walk fails a test, were its seed not fixed."""


class Skins(NamedTuple):
    """(n,) each: μa of epidermis and dermis, μs in cm⁻¹, g, thickness in µm."""

    epidermis: np.ndarray
    dermis: np.ndarray
    scattering: np.ndarray
    g: np.ndarray
    thickness: np.ndarray


def random_skins(count, seed):
    rng = np.random.default_rng(seed)
    melanin, blood, thickness, eumelanin, oxygenation = from_coordinates(rng.random((count, 5))).T
    band = rng.integers(0, len(WAVELENGTHS), count)
    lam = WAVELENGTHS[band]
    each = np.arange(count)
    return Skins(
        ALIAGA2022.epidermis_absorption(melanin, eumelanin, WAVELENGTHS)[each, band],
        ALIAGA2022.dermis_absorption(blood, oxygenation, WAVELENGTHS)[each, band],
        ALIAGA2022.scattering(lam),
        ALIAGA2022.anisotropy(lam),
        thickness,
    )


def walk(skins, dimension, seed, stop_at_interface=True):
    """Mean escaping weight and its standard error, (n,) each. Matched, Lambertian start inside."""
    rng = np.random.default_rng(seed)
    count = len(skins.g)
    which = np.repeat(np.arange(count), PHOTONS)
    mu = np.sqrt(rng.random(len(which)) if dimension == 3 else 1 - rng.random(len(which)) ** 2)
    depth, weight = np.zeros(len(which)), np.ones(len(which))
    below = np.zeros(len(which), dtype=bool)  # in the dermis
    identity = np.arange(len(which))
    escaped = np.zeros(len(which))
    interface = skins.thickness * 1e-4
    while len(which):
        mu_s, g, floor = skins.scattering[which], skins.g[which], interface[which]
        total = mu_s + np.where(below, skins.dermis[which], skins.epidermis[which])
        path = rng.exponential(size=len(which)) / total
        reached = depth + mu * path
        # A photon that would cross the interface stops there, keeps its direction and draws a new
        # free path in the other layer; only then may it meet the surface.
        down, up = ~below & (reached > floor), below & (reached < floor)
        if stop_at_interface:
            crosses = down | up
            depth = np.where(crosses, floor, reached)
            below = below ^ crosses
        else:
            crosses = down
            depth = np.where(crosses, floor, reached)
            below = (below | down) & ~up
        out = depth < 0
        escaped[identity[out]] = weight[out]
        scatters = ~crosses & ~out
        weight = np.where(scatters, weight * mu_s / total, weight)
        # Henyey–Greenstein, then rotation: cos φ of the azimuth is ±1 in flatland
        xi = rng.random(len(which))
        if dimension == 2:
            turn = 2 * np.arctan((1 - g) / (1 + g) * np.tan(np.pi / 2 * (1 - 2 * xi)))
            cosine, azimuth = np.cos(turn), np.sign(turn)
        else:
            cosine = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * xi)) ** 2) / (2 * g)
            azimuth = np.cos(2 * np.pi * rng.random(len(which)))
        sines = np.sqrt(np.maximum((1 - cosine**2) * (1 - mu**2), 0))
        mu = np.where(scatters, np.clip(mu * cosine + sines * azimuth, -1, 1), mu)
        # Russian roulette
        faint = weight < 0.05
        lives = ~out & (~faint | (rng.random(len(which)) < 0.2))
        weight = np.where(faint, weight * 5, weight)
        which, mu, depth, weight, below, identity = (
            x[lives] for x in (which, mu, depth, weight, below, identity)
        )
    scores = escaped.reshape(count, PHOTONS)
    return scores.mean(1), scores.std(1, ddof=1) / np.sqrt(PHOTONS)


def exact(skins, dimension):
    return np.array(
        [
            two_layer_albedo(e, d, t, float(s), float(g), dimension=dimension, count=40).item()
            for e, d, s, g, t in zip(*skins, strict=True)
        ]
    )


@pytest.mark.parametrize(("dimension", "count"), [(2, 14), (3, 6)])
def test_random_skins(dimension, count):
    """Every skin within the error of the walk (Bonferroni), and all of them together (χ²)."""
    skins = random_skins(count, seed=dimension)
    mean, error = walk(skins, dimension, seed=7)
    z = (mean - exact(skins, dimension)) / error
    assert np.all(error < 1.5e-3)
    assert np.abs(z).max() < norm.isf(LEVEL / (2 * count)), z
    assert np.sum(z**2) < chi2.isf(LEVEL, count), z


def test_a_walk_that_forgets_the_interface_is_caught():
    """Dark epidermis, clear dermis: photons from below must be stopped before the surface."""
    skins = Skins(*(np.array([x]) for x in (300.0, 0.5, 200.0, 0.8, 20.0)))
    albedo = exact(skins, 2)
    right, error = walk(skins, 2, seed=1)
    wrong, wrong_error = walk(skins, 2, seed=1, stop_at_interface=False)
    assert abs(right - albedo) < 3.5 * error
    assert abs(wrong - albedo) > 10 * wrong_error
    assert abs(wrong - albedo) > 1e-3
