"""RGB of skin from one light to another, as the spectra of a tissue have it.

`colour.light_conversion` takes colours for mixes of three broad bands, which skins are not. A 3 × 3
matrix fitted to the spectra of a tissue's skins leaves a third of its error on measured skin
(docs/colour.md). It is for skin alone: white does not stay quite white.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.space import albedo_space
from cutis.colour import LightLike, illuminant
from cutis.optics import Tissue

LIKELY = np.array([[0.005, 0.5], [0.003, 0.1], [20.0, 150.0], [0.2, 1.0], [0.2, 0.95]])
"""Ranges of the five parameters that the fit is over, evenly; of the first two, of their logs."""
SKINS = 4096
DARK = 0.01
"""Albedo added to the weight, so that the darkest skins do not rule."""


def skin_conversion(light: LightLike, tissue: Tissue) -> NDArray[np.float64]:
    """(3, 3) matrix C: linear sRGB of skin, balanced on `light`, → under D65, rgb @ C.T.

    Of relative squared error least over LIKELY skins of a tissue with the five free parameters.
    Raises CutisError for the lights that `colour.light_conversion` refuses.
    """
    if np.array_equal(illuminant(light), illuminant("D65")):
        return np.eye(3)
    from scipy.stats import qmc  # which takes a second to import

    low, high = LIKELY.T
    u = qmc.Halton(5, scramble=False).random(SKINS)
    skins = low + (high - low) * u
    skins[:, :2] = low[:2] * (high[:2] / low[:2]) ** u[:, :2]
    space = albedo_space(tissue)
    seen, true = (space.rgb(skins, name).astype(np.float64) for name in (light, "D65"))
    weight = 1 / (true.mean(axis=1, keepdims=True) + DARK)
    return np.linalg.lstsq(weight * seen, weight * true, rcond=None)[0].T
