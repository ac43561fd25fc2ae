"""Reflectance spectra → XYZ and linear RGB.

RGB here is linear sRGB: Rec.709 primaries, and a perfect white reflector is exactly (1, 1, 1)
under whichever illuminant it is seen, as if the camera were balanced on it.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour.observer import LightLike, colour_matching, illuminant, wavelengths
from cutis.errors import CutisError

XYZ_TO_SRGB = np.array(
    [
        [3.2409699419045213, -1.537383177570093, -0.49861076029300316],
        [-0.9692436362808794, 1.8759675015077202, 0.041555057407175536],
        [0.05563007969699364, -0.20397695888897674, 1.0569715142428786],
    ]
)
"""XYZ (Y of white = 1) → linear sRGB, from primaries and the D65 white (0.3127, 0.3290)
[iec61966]."""


def spectrum_to_xyz(wavelength: ArrayLike, light: LightLike = "D65") -> NDArray[np.float64]:
    """(n, 3) matrix that turns reflectance at `wavelength` (n,) nm into XYZ, Y of white = 1.

    `light` is a name or file for `illuminant`. The spectrum is taken as piecewise linear between
    its wavelengths and constant past its ends, and summed against observer and light every 5 nm.
    """
    lam = np.asarray(wavelength, dtype=np.float64)
    return _xyz_matrix(tuple(lam), illuminant(light).tobytes()).copy()


@lru_cache(maxsize=32)
def _xyz_matrix(lam: tuple[float, ...], light: bytes) -> NDArray[np.float64]:
    if len(lam) < 2 or not np.all(np.diff(lam) > 0):
        raise CutisError("wavelengths must be at least two, in nm and increasing")
    power = np.frombuffer(light)[:, None] * colour_matching()
    hats = np.stack([np.interp(wavelengths(), lam, np.eye(len(lam))[i]) for i in range(len(lam))])
    return hats @ power / power[:, 1].sum()


LEAST_WHITE = 1e-5
"""Of Y = 1; a light with less red, green or blue than this cannot be balanced on."""


def spectrum_to_rgb(wavelength: ArrayLike, light: LightLike = "D65") -> NDArray[np.float64]:
    """(n, 3) matrix that turns reflectance at `wavelength` (n,) nm into linear sRGB.

    Raises CutisError for lights, such as a sodium line, whose white is no mix of sRGB's primaries.
    """
    matrix = spectrum_to_xyz(wavelength, light) @ XYZ_TO_SRGB.T
    white = matrix.sum(axis=0)
    if white.min() < LEAST_WHITE:
        raise CutisError(
            f"the light {light} has too little {('red', 'green', 'blue')[int(white.argmin())]} to "
            "be white-balanced on; take one whose white is inside sRGB"
        )
    return matrix / white


def reflectance_to_rgb(
    reflectance: ArrayLike, wavelength: ArrayLike, light: LightLike = "D65"
) -> NDArray[np.float64]:
    """(..., n) reflectance in [0, 1] at (n,) nm → (..., 3) linear sRGB; white gives (1, 1, 1)."""
    return np.asarray(reflectance) @ spectrum_to_rgb(wavelength, light)
