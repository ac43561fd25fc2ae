"""How colours and maps look to people: on screen, in previews, on pages."""

import numpy as np
from numpy.typing import NDArray

from cutis.colour import encode_srgb

COLOUR_MAPS = {
    "melanin": "copper_r",
    "blood": "Reds",
    "thickness": "viridis",
    "eumelanin": "cividis",
    "oxygenation": "coolwarm",
}
"""The matplotlib colour map of each map."""


def displayed(rgb: NDArray[np.floating]) -> NDArray[np.floating]:
    """(H, W, 3) linear sRGB → what a screen shows, in [0, 1]."""
    return np.clip(encode_srgb(rgb), 0, 1)
