"""Published fits of single-scattering albedo to diffuse albedo, which renderers use.

All are for half spaces with an index-matched surface. `inversion` solves the same exactly; how far
the fits are from it is in docs/subsurface.md. Cycles 4.2 to 5.0 walks by `wrenninge2017`, so that
`cycles` inverts it.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def kulla_conty2017(albedo: ArrayLike, anisotropy: float = 0.0) -> Array:
    """α (...) of diffuse albedo (...), 0 to 1; anisotropy by similarity [kulla2017]."""
    a = np.asarray(albedo, dtype=np.float64)
    s = 4.09712 + 4.20863 * a - np.sqrt(9.59217 + 41.6808 * a + 17.7126 * a * a)
    return np.asarray((1 - s * s) / (1 - anisotropy * s * s))


def chiang2016(albedo: ArrayLike) -> Array:
    """α (...) of diffuse albedo (...), 0 to 1, isotropic [chiang2016]."""
    a = np.asarray(albedo, dtype=np.float64)
    return np.asarray(1 - np.exp(a * (-5.09406 + a * (2.61188 - a * 4.31805))))


def wrenninge2017(albedo: ArrayLike, anisotropy: float = 0.0) -> Array:
    """α (...) of diffuse albedo (...), 0 to 1, for anisotropy 0 to 0.99 [wrenninge2017]."""
    a, g = np.asarray(albedo, dtype=np.float64), anisotropy

    def polynomial(*coefficients: float) -> float:
        return float(np.polynomial.polynomial.polyval(g, coefficients))

    scale_dark = polynomial(
        1.8260523782, -1.28451056436, -1.79904629312, 9.19393289202, -22.8215585862,
        32.0234874259, -23.6264803333, 7.21067002658,
    )  # fmt: skip
    slope_dark = 4.98511194385 + 0.127355959438 * np.exp(polynomial(
        0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505, 2731.71560286,
        -1935.41424244, 559.009054474,
    ))  # fmt: skip
    power_dark = polynomial(
        1.09686102424, -0.394704063468, 1.05258115941, -8.83963712726, 28.8643230661,
        -46.8802913581, 38.5402837518, -12.7181042538,
    )  # fmt: skip
    scale_light = polynomial(
        0.496310210422, 0.360146581622, -2.15139309747, 17.8896899217, -55.2984010333,
        82.065982243, -58.5106008578, 15.8478295021,
    )  # fmt: skip
    slope_light = 4.23190299701 + 0.00310603949088 * np.exp(polynomial(
        0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998, 7116.60171912,
        -4763.54467887, 1303.5318055,
    ))  # fmt: skip
    power_light = polynomial(
        2.40602999408, -2.51814844609, 9.18494908356, -79.2191708682, 259.082868209,
        -403.613804597, 302.85712436, -87.4370473567,
    )  # fmt: skip
    blend = a**0.25
    dark = scale_dark * np.arctan(slope_dark * a) ** power_dark
    light = scale_light * np.arctan(slope_light * a) ** power_light
    return np.asarray((1 - blend) * dark + blend * light)
