"""Maps, σ and masks drawn over a face, with the scale that tells their colours."""

from typing import Any

import numpy as np

from cutis.looks import Look
from cutis.optics import NAMES, parameter
from cutis.report.appearance import COLOUR_MAPS, SURE, colour_map
from cutis.report.scale import Scale, tick_text
from cutis.studio.drawing import Codes, Drawer, Drawn, Region, codes
from cutis.studio.opening import OpenFace

TINT = np.array((255, 40, 60), np.float32)
"""Of masks, over what is under them."""
OPACITY = 0.6
GROUND = 38
"""Grey of what is no skin."""
STOPS = 16


def mask_over(
    drawer: Drawer, region: Region, look: Look, number: int, coarser: int
) -> tuple[Drawn, Codes]:
    """The edited face with the mask of a layer tinted over it."""
    drawn = drawer.edited(region, look, coarser)
    cover = drawer.cover(region, look, number, coarser).colours * np.float32(OPACITY)
    picture = codes(drawn.colours)
    return drawn, (picture + cover * (TINT - picture)).astype(np.uint8)


def map_picture(
    face: OpenFace, drawer: Drawer, region: Region, look: Look, show: str, coarser: int
) -> tuple[Drawn, Codes, dict[str, Any]]:
    """A map, σ or confidence in colours, and its scale: ends, ticks with their places, colours."""
    kind, _, name = show.partition(":")
    drawn = drawer.values(region, look, kind, name, coarser)
    scale, colours, unit = _scale(face, kind, name)
    table = colour_map(colours)
    place = np.nan_to_num(scale.place(drawn.colours[..., 0]))
    picture = table[np.rint(255 * place).astype(np.uint8)]
    picture[np.isnan(drawn.colours[..., 0])] = GROUND
    stops = table[np.rint(np.linspace(0, 255, STOPS)).astype(int)].tolist()
    said = {
        "unit": unit,
        "ticks": [[tick_text(v), round(float(scale.place(v)), 4)] for v in scale.ticks(4)],
        "colours": [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in stops],
    }
    return drawn, picture, {"bar": said}


def _scale(face: OpenFace, kind: str, name: str) -> tuple[Scale, str, str]:
    if kind == "confidence":
        return Scale(0.0, 1.0), SURE, ""
    known = parameter(name)
    unit = "" if known.unit == "1" else known.unit
    colours = COLOUR_MAPS.get(name, SURE)
    if kind == "sigma":
        smallest = face.levels.trusted(face.levels.all[-1])[..., NAMES.index(name)]
        return Scale(0.0, max(float(np.percentile(smallest, 95)), 1e-6)), colours, unit
    quantiles = face.file.known
    if quantiles is None or name not in NAMES:
        return Scale(known.low, known.high, known.root), colours, unit
    low, high = (float(quantiles.percentile(name, share)) for share in (0.005, 0.995))
    return Scale(low, max(high, low * 1.01 + 1e-6), known.root), colours, unit
