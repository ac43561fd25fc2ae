"""The sRGB transfer function, exact at its toe [iec61966]."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def _working(values: ArrayLike) -> NDArray[np.floating]:
    x = np.asarray(values)
    return x if x.dtype in (np.float32, np.float64) else x.astype(np.float64)


def encode_srgb(linear: ArrayLike) -> NDArray[np.floating]:
    """Linear → encoded sRGB, any shape; float32 stays float32; odd about 0, not clamped."""
    x = _working(linear)
    size = np.abs(x)
    power = 1.055 * np.maximum(size, 0.0031308) ** x.dtype.type(1 / 2.4) - 0.055
    return np.copysign(np.where(size <= 0.0031308, 12.92 * size, power), x).astype(x.dtype)


def decode_srgb(encoded: ArrayLike) -> NDArray[np.floating]:
    """Encoded sRGB → linear, any shape; float32 stays float32; odd about 0, not clamped."""
    x = _working(encoded)
    size = np.abs(x)
    power = ((np.maximum(size, 0.04045) + 0.055) / 1.055) ** x.dtype.type(2.4)
    return np.copysign(np.where(size <= 0.04045, size / 12.92, power), x).astype(x.dtype)
