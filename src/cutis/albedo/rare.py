"""What rare chromophores do to the colour of a skin, whatever model decodes the rest."""

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.space import albedo_space
from cutis.optics import PARAMETERS, Tissue, with_rare_chromophores

DARKEST = np.float32(1e-4)
"""Albedo that the ratio is taken over at least, so that it stays finite."""


def rare_ratio(tissue: Tissue, skins: NDArray[np.float32]) -> NDArray[np.float32]:
    """(n, 8) skins → (n, 3): linear sRGB over that of the same skins without rare chromophores.

    From the exact albedo space of the tissue. Skins without give 1 exactly.
    """
    space = albedo_space(with_rare_chromophores(tissue))
    ratio = np.ones((len(skins), 3), dtype=np.float32)
    some = skins[:, len(PARAMETERS) :].any(axis=1)
    plain = skins[some]
    plain[:, len(PARAMETERS) :] = 0
    ratio[some] = space.rgb(skins[some]) / np.maximum(space.rgb(plain), DARKEST)
    return ratio
