"""Kubelka–Munk theory: two diffuse fluxes, the baseline that the paper compares with.

In a layer with coefficients K, S (cm⁻¹) a flux loses K + S of itself per cm and gains S of the one
that comes the other way [kubelka1931, kubelka1948]. Absorption and scattering of radiative transfer
become K and S only by approximation; `coefficients` offers three that were published.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError

Array = NDArray[np.float64]

CONVERSIONS = ("gate1974", "star1988", "plain")


def coefficients(
    absorption: ArrayLike, reduced_scattering: ArrayLike, conversion: str = "gate1974"
) -> tuple[Array, Array]:
    """K and S from μa and μs′, all in cm⁻¹, any shapes that fit.

    gate1974: K = 2 μa, S = ¾ μs′, derived again by [thennadil2008]. star1988: K = 2 μa,
    S = ¾ μs′ − ¼ μa, not below 0 [star1988]. plain: K = μa, S = μs′, as published code of Alotaibi
    and Smith has it [alotaibi2017]. Raises CutisError for coefficients that are negative, not
    finite or both zero.
    """
    mu_a, mu_s = np.broadcast_arrays(
        np.asarray(absorption, dtype=np.float64), np.asarray(reduced_scattering, dtype=np.float64)
    )
    if not np.all(np.isfinite(mu_a) & np.isfinite(mu_s) & (mu_a >= 0) & (mu_s >= 0)):
        raise CutisError("absorption and reduced scattering must be finite, not negative")
    if np.any(mu_a + mu_s == 0):
        raise CutisError("absorption and reduced scattering must not both be zero")
    if conversion == "plain":
        return mu_a.copy(), mu_s.copy()
    if conversion == "gate1974":
        return 2.0 * mu_a, 0.75 * mu_s
    if conversion == "star1988":
        return 2.0 * mu_a, np.maximum(0.75 * mu_s - 0.25 * mu_a, 0.0)
    raise CutisError(f"conversion must be {', '.join(CONVERSIONS)}, not {conversion!r}")


def half_space(k: ArrayLike, s: ArrayLike) -> Array:
    """Reflectance of an infinitely deep layer, 1 + K/S − √(K²/S² + 2 K/S), without cancellation."""
    kk, ss = np.asarray(k, dtype=np.float64), np.asarray(s, dtype=np.float64)
    total = kk + ss
    return np.asarray(ss / (total + np.sqrt(kk * (kk + 2.0 * ss))))


def layer(k: ArrayLike, s: ArrayLike, depth: ArrayLike) -> tuple[Array, Array]:
    """Reflectance and transmittance of a layer of `depth` cm, nothing behind it [kubelka1948].

    Regular where nothing absorbs (R = S d / (1 + S d)), nothing scatters (T = e^−Kd), and for any
    depth up to infinity.
    """
    kk, ss, d = np.broadcast_arrays(
        *(np.asarray(values, dtype=np.float64) for values in (k, s, depth))
    )
    rate = np.sqrt(kk * (kk + 2.0 * ss))
    with np.errstate(invalid="ignore"):
        x = np.where(rate > 0, rate * d, 0.0)
    shrink = np.exp(-x)
    gap = -np.expm1(-2.0 * x)  # 2 e^−x sinh x
    small = x < 1e-7
    # sinh x / rate → d where nothing absorbs; both sides are divided by e^x
    length = np.where(small, d, gap / (2.0 * np.where(small, 1.0, rate)))
    below = 1.0 - 0.5 * gap + (kk + ss) * length
    return ss * length / below, shrink / below


def over(reflectance: ArrayLike, transmittance: ArrayLike, background: ArrayLike) -> Array:
    """Reflectance of a symmetric layer upon a background reflectance [kubelka1948]."""
    r, t, b = (np.asarray(v, dtype=np.float64) for v in (reflectance, transmittance, background))
    return np.asarray(r + t * t * b / (1.0 - r * b))
