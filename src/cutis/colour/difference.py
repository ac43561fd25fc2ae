"""What reports say of colours: CIELAB, CIEDE2000 and ITA°, under D65."""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.spectra import XYZ_TO_SRGB

D65_WHITE = (0.3127, 0.3290)
"""Chromaticity x, y of the white of linear sRGB."""
LIGHTEST_HAIR, PALEST = 35.0, 12.0
"""L* and C*ab that lie below those of skin that errors are reported on."""


@cache
def to_relative_xyz() -> NDArray[np.float64]:
    """(3, 3) linear sRGB → XYZ over that of white."""
    x, y = D65_WHITE
    white = np.array([x / y, 1.0, (1 - x - y) / y])
    # of the same RGB as spectra, so that greys stay neutral
    return np.ascontiguousarray(np.linalg.inv(XYZ_TO_SRGB) / white[:, None])


def _flat(rgb: ArrayLike) -> NDArray[np.floating]:
    values = np.asarray(rgb)
    kind = values.dtype if values.dtype in (np.float32, np.float64) else np.dtype(np.float64)
    return np.ascontiguousarray(values.reshape(-1, 3), dtype=kind)


def lab(rgb: ArrayLike) -> NDArray[np.float32]:
    """(..., 3) linear sRGB → (..., 3) CIELAB under D65 (L* 0–100, a*, b*)."""
    from cutis.kernels.difference_kernel import lab_kernel

    flat = _flat(rgb)
    result = np.empty(flat.shape, dtype=np.float32)
    lab_kernel(len(flat), flat, to_relative_xyz(), result)
    return result.reshape(np.shape(rgb))


def delta_e(rgb_a: ArrayLike, rgb_b: ArrayLike) -> NDArray[np.float32]:
    """CIEDE2000 between (..., 3) linear sRGB colours → (...) [sharma2005ciede2000]."""
    from cutis.kernels.difference_kernel import delta_e_kernel

    a, b = _flat(rgb_a), _flat(rgb_b)
    result = np.empty(len(a), dtype=np.float32)
    delta_e_kernel(len(a), a, b, to_relative_xyz(), result)
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
    return (values[..., 0] > LIGHTEST_HAIR) & (np.hypot(values[..., 1], values[..., 2]) > PALEST)
