"""RGB → reflectance by the basis of Mallett and Yuksel, and RGB from one light to another.

The basis is three reflectances whose colours under D65 are pure red, green and blue and which add
up to white, so every mix of them with shares in [0, 1] is a reflectance [mallett2019]. For another
light the mix is sought that has the given colour under that light. All is linear: the way from
light to light is a 3 × 3 matrix, and white stays white.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.observer import LightLike, illuminant, wavelengths
from cutis.colour.spectra import spectrum_to_rgb
from cutis.optics.tables import packaged_table


def mallett_basis() -> NDArray[np.float64]:
    """(81, 3) reflectances of red, green and blue at `observer.wavelengths()` [mallett2019]."""
    table = packaged_table("colour", "mallett2019")
    return np.stack([table["red"], table["green"], table["blue"]], axis=-1)


def upsample(rgb: ArrayLike, light: LightLike = "D65") -> NDArray[np.float64]:
    """(..., 3) linear sRGB, white-balanced under `light` → (..., 81) reflectance every 5 nm.

    Under `light` the reflectance has the given colour again; for very saturated colours under
    lights of few lines it may leave [0, 1].
    """
    basis = mallett_basis()
    shares = np.asarray(rgb) @ np.linalg.inv(basis.T @ spectrum_to_rgb(wavelengths(), light))
    return shares @ basis.T


def light_conversion(source: LightLike, target: LightLike = "D65") -> NDArray[np.float64]:
    """(3, 3) matrix C: linear sRGB white-balanced under `source` → under `target`, rgb @ C.T."""
    if np.array_equal(illuminant(source), illuminant(target)):
        return np.eye(3)
    return (upsample(np.eye(3), source) @ spectrum_to_rgb(wavelengths(), target)).T
