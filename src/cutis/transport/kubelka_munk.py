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

    gate1974: K = 2 μa, S = ¾ μs′ [gate1974], derived again by [thennadil2008]. star1988: K = 2 μa,
    S = ¾ μs′ − ¼ μa, not below 0 [star1988]. plain: K = μa, S = μs′, as the code published with
    [alotaibi2019] has it. Raises CutisError for coefficients that are negative, not
    finite or both zero.
    """
    mu_a, mu_s = np.broadcast_arrays(
        *_checked("absorption and reduced scattering", absorption, reduced_scattering)
    )
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
    """Reflectance of an infinitely deep layer, 1 + K/S − √(K²/S² + 2 K/S), without cancellation.

    K, S in cm⁻¹, any shapes that fit. Raises CutisError for coefficients that are negative, not
    finite or both zero.
    """
    kk, ss = _checked("K and S", k, s)
    total = kk + ss
    if np.any(total == 0):
        raise CutisError("K and S must not both be zero in an infinitely deep layer")
    return np.asarray(ss / (total + np.sqrt(kk * (kk + 2.0 * ss))))


def layer(k: ArrayLike, s: ArrayLike, depth: ArrayLike) -> tuple[Array, Array]:
    """Reflectance and transmittance of a layer of `depth` cm, nothing behind it [kubelka1948].

    Regular where nothing absorbs (R = S d / (1 + S d)), nothing scatters (T = e^−Kd), and for any
    depth up to infinity. Raises CutisError for coefficients or depths that are negative or NaN.
    """
    kk, ss = _checked("K and S", k, s)
    d = np.asarray(depth, dtype=np.float64)
    if not np.all(d >= 0):  # also catches NaN
        raise CutisError("depth must be a number that is not negative")
    kk, ss, d = np.broadcast_arrays(kk, ss, d)
    rate = np.sqrt(kk * (kk + 2.0 * ss))
    x = np.multiply(rate, d, out=np.zeros(d.shape), where=rate > 0)
    shrink = np.exp(-x)
    gap = -np.expm1(-2.0 * x)  # 2 e^−x sinh x
    small = x < 1e-7
    # sinh x / rate → d where nothing absorbs; both sides are divided by e^x
    thin = np.where(small, d, 0.0) * shrink
    length = np.where(small, thin, gap / (2.0 * np.where(small, 1.0, rate)))
    scattered = np.multiply(ss, length, out=np.zeros(d.shape), where=ss > 0)
    absorbed = np.multiply(kk, length, out=np.zeros(d.shape), where=kk > 0)
    below = 1.0 - 0.5 * gap + absorbed + scattered
    endless = np.isinf(scattered)  # a half space without absorption returns everything
    ratio = np.divide(scattered, below, out=np.ones(d.shape), where=~endless)
    return ratio, np.where(endless, 0.0, shrink / below)


def over(reflectance: ArrayLike, transmittance: ArrayLike, background: ArrayLike) -> Array:
    """Reflectance of a symmetric layer upon a background reflectance [kubelka1948].

    A stack is built from the bottom up, each layer upon the reflectance of what lies below it.
    Raises CutisError for shares outside 0 to 1.
    """
    r, t, b = np.broadcast_arrays(
        *(np.asarray(v, dtype=np.float64) for v in (reflectance, transmittance, background))
    )
    if not all(np.all((share >= 0) & (share <= 1)) for share in (r, t, b)):
        raise CutisError("reflectance, transmittance and background must lie in 0 to 1")
    # R = 1 leaves T = 0: what is below is not seen
    seen = np.divide(b, 1.0 - r * b, out=np.zeros(r.shape), where=r < 1)
    return np.asarray(r + t * t * seen)


def _checked(names: str, *values: ArrayLike) -> list[Array]:
    arrays = [np.asarray(v, dtype=np.float64) for v in values]
    if not all(np.all(np.isfinite(a) & (a >= 0)) for a in arrays):
        raise CutisError(f"{names} must be finite, not negative")
    return arrays
