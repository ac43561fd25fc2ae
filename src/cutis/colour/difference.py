"""What reports say of colours: CIELAB, CIEDE2000 and ITA°, by colour-science, under D65.

colour-science takes seconds to import, so it is imported where it is used.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spectra import XYZ_TO_SRGB

BAND = 1 << 18
"""Texels worked on at a time, so that memory does not grow with the image."""
D65_WHITE = (0.3127, 0.3290)
"""Chromaticity x, y of the white of linear sRGB."""


def _bands(count: int) -> Iterator[slice]:
    return (slice(start, start + BAND) for start in range(0, count, BAND))


def lab(rgb: ArrayLike) -> NDArray[np.float32]:
    """(..., 3) linear sRGB → (..., 3) CIELAB under D65 (L* 0–100, a*, b*)."""
    from colour import XYZ_to_Lab

    matrix = np.linalg.inv(XYZ_TO_SRGB)  # of the same RGB as spectra, so that greys stay neutral
    flat = np.asarray(rgb).reshape(-1, 3)
    result = np.empty(flat.shape, dtype=np.float32)
    for band in _bands(len(flat)):
        result[band] = XYZ_to_Lab(flat[band].astype(np.float64) @ matrix.T, D65_WHITE)
    return result.reshape(np.shape(rgb))


def delta_e(rgb_a: ArrayLike, rgb_b: ArrayLike) -> NDArray[np.float32]:
    """CIEDE2000 between (..., 3) linear sRGB colours → (...) [sharma2005ciede2000]."""
    from colour.difference import delta_E_CIE2000

    a, b = np.asarray(rgb_a).reshape(-1, 3), np.asarray(rgb_b).reshape(-1, 3)
    result = np.empty(len(a), dtype=np.float32)
    for band in _bands(len(a)):
        result[band] = delta_E_CIE2000(lab(a[band]), lab(b[band]))
    return result.reshape(np.shape(rgb_a)[:-1])


def ita(rgb: ArrayLike) -> NDArray[np.float32]:
    """Individual typology angle, degrees, of (..., 3) linear sRGB → (...) [chardon1991ita].

    Above 55 very light, 41–55 light, 28–41 intermediate, 10–28 tan, −30–10 brown, below dark.
    """
    values = lab(rgb)
    return np.degrees(np.arctan2(values[..., 0] - 50.0, values[..., 2]))


def is_skin_colour(rgb: ArrayLike) -> NDArray[np.bool_]:
    """Texels that colour errors are reported on, L* > 35 and C*ab > 12: (..., 3) → (...)."""
    values = lab(rgb)
    return (values[..., 0] > 35.0) & (np.hypot(values[..., 1], values[..., 2]) > 12.0)
