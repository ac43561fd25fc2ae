"""The medium in Mitsuba: a path tracer that knows nothing of the solver."""

import numpy as np
import pytest
from scipy.stats import norm

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.render.inversion import single_scattering_albedo
from cutis.render.mitsuba_patch import patch_albedo
from cutis.transport import fresnel_reflectance, half_space_albedo

pytest.importorskip("mitsuba", reason="pip install 'cutis[mitsuba]'")

LEVEL = 1e-3
"""Chance that a test fails on a right inversion; fixed before the first run."""


@pytest.mark.slow
@pytest.mark.parametrize(("g", "every"), [(0.0, 1), (0.7, 5)])
def test_patches_of_skin_return_the_albedo_asked_for(g, every):
    """24 skins from very light to very dark; fewer where a walk takes longer."""
    melanin = (0.003, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6)
    skins = [(m, b, 100.0, 0.7, 0.75) for m in melanin for b in (0.002, 0.02, 0.08)]
    tones = albedo_space().rgb(np.array(skins))[::every]
    bound = norm.isf(LEVEL / (2 * tones.size))
    for number, albedo in enumerate(tones):
        found = patch_albedo(single_scattering_albedo(albedo, g), g, samples=48, seed=number)
        z = (found.albedo - albedo) / found.error
        assert (np.abs(z) < bound).all(), (albedo, z)
        assert (found.error < 0.025 * albedo).all()


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
