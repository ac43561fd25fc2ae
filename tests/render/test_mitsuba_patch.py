"""The medium in Mitsuba: a path tracer that knows nothing of the solver."""

import numpy as np
import pytest
from scipy.stats import norm

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022
from cutis.render.inversion import single_scattering_albedo
from cutis.render.mitsuba_patch import patch_albedo
from cutis.transport import fresnel_reflectance, half_space_albedo

pytest.importorskip("mitsuba", reason="pip install 'cutis[mitsuba]'")

LEVEL = 1e-3
"""Chance that a test fails on a right inversion; fixed before the first run."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "every"),
    [
        (0.0, 3),
        (0.7, 8),
        *(pytest.param(*how, marks=pytest.mark.long) for how in [(0.0, 1), (0.7, 5)]),
    ],
)
def test_patches_of_skin_return_the_albedo_asked_for(g, every):
    """24 skins from very light to very dark; fewer where a walk takes longer.

    Each of them, and in each channel all of the darker and of the lighter half together, whose
    noise is half a per cent and less.
    """
    melanin = (0.003, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
    skins = [(m, b, 100.0, 0.7, 0.75) for m in melanin for b in (0.002, 0.02, 0.08)]
    tones = albedo_space(ALIAGA2022).rgb(np.array(skins))[::every]
    found = [
        patch_albedo(single_scattering_albedo(albedo, g), g, samples=48, seed=number)
        for number, albedo in enumerate(tones)
    ]
    off = np.stack([one.albedo for one in found]) / tones - 1
    error = np.stack([one.error for one in found]) / tones
    assert error.max() < 0.025
    assert np.abs(off / error).max() < norm.isf(LEVEL / (4 * tones.size))
    for channel, order in enumerate(np.argsort(tones, axis=0).T):
        for some in np.array_split(order, 2):
            weight = error[some, channel] ** -2
            together, noise = weight @ off[some, channel] / weight.sum(), weight.sum() ** -0.5
            assert noise < 0.006 * np.sqrt(every)
            assert abs(together) < norm.isf(LEVEL / 24) * noise, (channel, together)


def test_a_dielectric_surface():
    """Light from everywhere: reflected at once, or refracted, walked, and let out by the solver."""
    n, g = 1.4, 0.3
    alpha = np.array([0.5, 0.9, 0.99])
    x, w = np.polynomial.legendre.leggauss(24)
    outside = 0.5 * (x + 1)
    share = w * outside  # ∫ 2 μ dμ
    inside = np.sqrt(1 - (1 - outside**2) / n**2)
    reflected = fresnel_reflectance(outside, n)
    plane = np.stack([
        half_space_albedo((1 - alpha) / alpha, 1.0, g, refractive_index=n, incidence=float(mu))
        for mu in inside
    ])  # fmt: skip
    wanted = share @ (reflected[:, None] + (1 - reflected[:, None]) * plane)
    found = patch_albedo(alpha, g, n, samples=128)
    z = np.abs((found.albedo - wanted) / found.error).max()
    assert z < norm.isf(LEVEL / 6)


def test_what_is_no_medium_is_refused():
    for bad in ([0.5, 0.5], [0.5, 0.5, 1.5], [0.5, 0.5, np.nan]):
        with pytest.raises(CutisError, match="three"):
            patch_albedo(bad)
