"""Reflection of unpolarised light at a smooth dielectric boundary."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def fresnel_reflectance(cosine: ArrayLike, index_ratio: float) -> NDArray[np.float64]:
    """Mean of s and p reflectance, in [0, 1], for incidence at cos θ = `cosine` (any shape).

    `index_ratio` is the refractive index on the far side over that on the near side; beyond the
    critical angle the result is 1.
    """
    mu = np.asarray(cosine, dtype=np.float64)
    sine2 = (1.0 - mu * mu) / index_ratio**2
    far = np.sqrt(np.maximum(1.0 - sine2, 0.0))
    s = (mu - index_ratio * far) / (mu + index_ratio * far)
    p = (index_ratio * mu - far) / (index_ratio * mu + far)
    return np.where(sine2 < 1.0, 0.5 * (s * s + p * p), 1.0)
