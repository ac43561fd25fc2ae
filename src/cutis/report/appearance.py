"""How colours and maps look to people: on screen, in previews, on pages."""

from functools import lru_cache
from importlib import resources

import numpy as np

from cutis.arrays import Bytes, Floats
from cutis.colour import encode_srgb

COLOUR_MAPS = {
    "melanin": "copper_r",
    "blood": "Reds",
    "thickness": "viridis",
    "eumelanin": "cividis",
    "oxygenation": "coolwarm",
}
"""The colour map of each map, by the name that matplotlib gives it too."""
ERRORS, SURE = "magma", "viridis"
"""Those of colour differences and of confidence."""


@lru_cache
def colour_map(name: str, levels: int = 256) -> Bytes:
    """(levels, 3) encoded sRGB of a colour map from low to high, of at most 256 colours.

    The tables are `data/page/colour_maps.csv`; `python -m studies.build_appearance` writes them.
    """
    file = resources.files("cutis.data").joinpath("page", "colour_maps.csv")
    heads, *rows = [
        line.split(",") for line in file.read_text("utf-8").splitlines() if line[0] != "#"
    ]
    columns = [heads.index(f"{name} {channel}") for channel in ("red", "green", "blue")]
    table = np.array([[int(row[c]) for c in columns] for row in rows], dtype=np.uint8)
    table = table[np.rint(np.linspace(0, 255, levels)).astype(int)]
    table.flags.writeable = False
    return table


def displayed(rgb: Floats) -> Floats:
    """(H, W, 3) linear sRGB → what a screen shows, in [0, 1]."""
    return np.clip(encode_srgb(rgb), 0, 1)
