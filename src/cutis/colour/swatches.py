"""Colours that people name: codes of pickers, and the Monk Skin Tone scale."""

import numpy as np
from numpy.typing import NDArray

from cutis.colour.transfer import decode_srgb

MONK = ("f6ede4", "f3e7db", "f7ead0", "eadaba", "d7bd96", "a07e56", "825c43", "604134", "3a312a",
        "292420")  # fmt: skip
"""The ten tones, light to dark, as sRGB [monk2023scale]: display colours, not measured skin."""


def swatch(text: str) -> NDArray[np.floating]:
    """`8d5524` → (3,) linear sRGB."""
    return decode_srgb(np.array([int(text[i : i + 2], 16) / 255 for i in (0, 2, 4)]))
