"""Tracks of sliders, painted with the skin that each place of them would give."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cutis.errors import CutisError
from cutis.looks import Look
from cutis.looks.edits import MapEdit
from cutis.maps import Maps
from cutis.maps.changes import Tile
from cutis.optics import NAMES, RARE_NAMES, TYPICAL
from cutis.studio.drawing import codes
from cutis.studio.opening import OpenFace

STEPS = 24
"""Colours of a track."""
SPANS: dict[str, tuple[str, float, float]] = {
    "melanin": ("multiply", 0.25, 4.0),
    "blood": ("multiply", 0.25, 4.0),
    "thickness": ("multiply", 0.5, 2.0),
    "eumelanin": ("offset", -0.5, 0.5),
    "oxygenation": ("offset", -0.5, 0.5),
    "bilirubin": ("offset", 0.0, 0.2),
    "carotene": ("offset", 0.0, 0.05),
    "methaemoglobin": ("offset", 0.0, 0.7),
}
"""What the slider of each map does, and from where to where; factors in even ratios."""
LIMITS = {"set", "floor", "ceiling"}


def values_of(name: str, do: str) -> list[float]:
    """The places of a track: even ratios for factors, even steps else."""
    from cutis.optics import parameter

    usual, low, high = SPANS[name]
    if do == usual:
        pass
    elif do == "multiply":
        low, high = 0.25, 4.0
    elif do in LIMITS:
        known = parameter(name)
        ends = np.linspace(0, 1, STEPS)
        return [float(v) for v in known.from_coordinate(ends)]
    elif do == "offset":
        known = parameter(name)
        low, high = -0.5 * known.high, 0.5 * known.high
    else:
        raise CutisError(f"there is no track of {do}")
    if do == "multiply":
        return [float(v) for v in np.geomspace(low, high, STEPS)]
    return [float(v) for v in np.linspace(low, high, STEPS)]


def median_skin(face: OpenFace) -> dict[str, float]:
    """The medians of the five maps; of no skin at all, a light one."""
    known = face.file.known
    if known is None:
        return dict(TYPICAL)
    return {name: float(known.percentile(name, 0.5)) for name in NAMES}


def tracks(face: OpenFace, layer: Any, does: Mapping[str, str]) -> dict[str, Any]:
    """For maps by name, with what their slider does: its values and as many colours, #rrggbb.

    They are those of the face's median skin with the other plain edits of `layer`, a layer of a
    look, in it.
    """
    skin = median_skin(face)
    rows: list[Maps] = []
    places: dict[str, list[float]] = {}
    for name, do in does.items():
        places[name] = values_of(name, do)
        others = [
            edit for edit in layer.edits
            if isinstance(edit, MapEdit) and edit.areas == "all" and edit.map != name
        ]  # fmt: skip
        rows += [_skin(skin, others, name, do, value) for value in places[name]]
    names = (*NAMES, *RARE_NAMES) if any(one.rare for one in rows) else NAMES
    skins = np.concatenate([one.parameters(names)[0] for one in rows])
    model, calibration = face.model, face.file.header.calibration
    found = codes(calibration.undo(model.decode(skins))[None])[0]
    hexes = [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in found.tolist()]
    return {
        name: {"values": values, "colours": hexes[i * STEPS : (i + 1) * STEPS]}
        for i, (name, values) in enumerate(places.items())
    }


def _skin(
    skin: Mapping[str, float], others: Sequence[MapEdit], name: str, do: str, value: float
) -> Maps:
    from cutis.maps import Edit

    values = {n: np.full((1, 1), v, np.float32) for n, v in skin.items()}
    tile = Tile(Maps(values, np.ones((1, 1), np.float32)))
    for edit in others:
        plain, share = edit.plain()
        tile = _edited(tile, plain, share)
    return _edited(tile, Edit(name, do, value), 1.0).maps


def _edited(tile: Tile, edit: Any, share: float) -> Tile:
    new, _ = edit(tile.maps[edit.parameter], np.full((1, 1), share, np.float32))
    return Tile(tile.maps.with_values({edit.parameter: new}))


def thumbnail(face: OpenFace, look: Look, longest: int = 112) -> Any:
    """The face with a look, (h, w, 3) linear sRGB, of the level that is at least so long."""
    from cutis.studio.drawing import Drawer, Region

    height, width = face.shape
    scale = longest / max(height, width)
    return Drawer(face).edited(Region(0, 0, width, height, scale), look).colours
