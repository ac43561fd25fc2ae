"""Subsurface inversion: diffuse albedo ↔ single-scattering albedo of a semi-infinite medium.

A renderer's random walk asks for the medium's single-scattering albedo α = μs / (μs + μa); people
paint the diffuse albedo A, the share of light that comes out again after any number of scattering
events. In a homogeneous half space A depends on α, on the anisotropy g and on what happens at the
surface, not on lengths. The exact solver gives A(α) in three dimensions; s = √(1 − α) is a smooth
function of A from 1 (black) to 0 (white), so that a spline through exact nodes inverts it.

`refractive_index` 1 is the index-matched surface, at which light passes as it comes: what a
renderer walks in when the surface is another lobe's business. Else it is that of a smooth
dielectric in air, which throws light back inside. In both cases light starts inside, Lambertian,
and A is the share of it that leaves. Of light that falls on the dielectric from outside, Lambertian
too, a share ρ is reflected at once (`fresnel_reflectance` averaged over directions), and
ρ + (1 − ρ) A comes back as long as what enters is close to Lambertian.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from cutis.errors import CutisError
from cutis.transport import half_space_albedo

NODES = 96
"""Exact solutions that an inversion is made from."""
STEPS = 1 << 14
"""Equal steps of the root of diffuse albedo in the table of it."""
SLACK = 1e-6
"""How far beyond 0 to 1 rounding may carry an albedo."""


def diffuse_albedo(
    single_scattering: ArrayLike, anisotropy: float = 0.0, refractive_index: float = 1.0
) -> NDArray[np.float64]:
    """Diffuse albedo of half spaces of `single_scattering` (...), 0 to 1, exact to 1e-6.

    `anisotropy` is the g of Henyey–Greenstein, −0.95 to 0.95. Raises CutisError for values out of
    range.
    """
    alpha = _checked(single_scattering, "single-scattering albedo")
    _check_medium(anisotropy, refractive_index)
    found = np.zeros(alpha.shape)
    some = alpha > 0
    absorption = (1 - alpha[some]) / alpha[some]
    if absorption.size:
        found[some] = half_space_albedo(
            absorption, 1.0, anisotropy, refractive_index=refractive_index,
            count=48 if abs(anisotropy) <= 0.8 else 128,
        )  # fmt: skip
    return np.clip(found, 0, 1)


def single_scattering_albedo(
    albedo: ArrayLike, anisotropy: float = 0.0, refractive_index: float = 1.0
) -> NDArray[np.floating]:
    """Single-scattering albedo of the half spaces whose diffuse albedo is `albedo` (...), 0 to 1.

    The inverse of `diffuse_albedo`; float32 stays float32. Raises CutisError for values out of
    range, NaN among them.
    """
    given = np.asarray(albedo)
    wanted = _checked(given, "diffuse albedo")
    _check_medium(anisotropy, refractive_index)
    root = _table(float(anisotropy), float(refractive_index))
    s = from_table(root, np.sqrt(wanted))
    found = 1 - s * s
    return found.astype(np.float32) if given.dtype == np.float32 else found


def from_table(table: NDArray[np.float64], place: NDArray[np.floating]) -> NDArray[np.floating]:
    """Linear interpolation in values at equal steps from 0 to 1, at `place` (...), 0 to 1.

    Several times as fast as `numpy.interp`, which searches.
    """
    scaled = place * (len(table) - 1)
    below = np.minimum(scaled.astype(np.int32), len(table) - 2)
    scaled -= below
    low = table[below]
    return np.asarray(low + scaled * (table[below + 1] - low))


@lru_cache(maxsize=16)
def _table(anisotropy: float, refractive_index: float) -> NDArray[np.float64]:
    """s = √(1 − α) at STEPS + 1 equal steps of the root of diffuse albedo: fine in the dark."""
    s = 0.5 - 0.5 * np.cos(np.pi * np.arange(NODES + 1) / NODES)  # dense at both ends
    albedo = diffuse_albedo(1 - s * s, anisotropy, refractive_index)
    albedo[0], albedo[-1] = 1, 0  # nothing absorbed, nothing scattered
    root = CubicSpline(np.sqrt(albedo[::-1]), s[::-1])(np.linspace(0, 1, STEPS + 1))
    root.flags.writeable = False
    return np.asarray(root)


def _checked(values: ArrayLike, name: str) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64)
    bad = ~((found >= -SLACK) & (found <= 1 + SLACK))
    if bad.any():
        raise CutisError(f"{int(bad.sum())} values of the {name} are not within 0 to 1")
    return np.clip(found, 0, 1)


def _check_medium(anisotropy: float, refractive_index: float) -> None:
    if not -0.95 <= anisotropy <= 0.95:
        raise CutisError(f"anisotropy = {anisotropy:g}: it must lie in -0.95 to 0.95")
    if not 1 <= refractive_index <= 3:
        raise CutisError(f"refractive index = {refractive_index:g}: it must lie in 1 to 3")
