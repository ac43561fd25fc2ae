"""What is under the pointer: colours, the five parameters with their σ, the spectrum."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.colour import ita, lab
from cutis.errors import CutisError
from cutis.looks import Look
from cutis.maps import Maps, SkinMaps
from cutis.maps import colours as maps_colours
from cutis.maps.skin_maps import Recolouring
from cutis.optics import NAMES, RARE_NAMES, WAVELENGTHS, parameter
from cutis.studio.opening import OpenFace
from cutis.textures.texture import from_unit

Reading = dict[str, Any]


def reading(face: OpenFace, look: Look, row: int, column: int, light: str | None = None) -> Reading:
    """What is at a texel, as captured and with a look; CutisError beyond the face.

    `stored` are values as the file has them, `lab`, `ita` under D65, `maps` by name value and σ,
    `spectrum` reflectance at `optics.WAVELENGTHS`, None where there is no skin.
    """
    height, width = face.shape
    if not (0 <= row < height and 0 <= column < width):
        raise CutisError("the pointer is beyond the face")
    source = np.array(face.levels.all[0].colours[row, column], np.float32)
    found: Reading = {
        "at": [column, row], "space": face.space.name, "depth": face.stored.name,
        "original": _colours(face, source), "edited": None, "skin": False,
    }  # fmt: skip
    if not face.ready:
        return found
    level = face.levels.all[0]
    change = face.change(look, level)
    reach = change.reach
    first, last = max(0, row - reach), min(height, row + reach + 1)
    part = face.sigmas(row) if not reach else None
    skin = level.rows(slice(first, last), trust=change.trust or (part is None))
    if part is not None:
        skin = _with_trust(skin, part)
    edited = skin.changed_by(change.rows(slice(first, last))) if change.told else skin
    one, was = (
        edited.rows(slice(row - first, row - first + 1)),
        skin.rows(slice(row - first, row - first + 1)),
    )
    inside = bool(was.mask[0, column] > 0)
    found["skin"] = inside
    model, calibration = face.model, face.file.header.calibration
    _, colours = Recolouring(model, calibration, light)(one, np.asarray(was.source))
    found["edited"] = _colours(face, colours[0, column])
    if was.confidence is not None:
        found["confidence"] = round(float(was.confidence[0, column]), 3)
    for name, which in (("original", was), ("edited", one)):
        found[name]["maps"] = _values(which, column) if inside else {}
        found[name]["spectrum"] = _spectrum(face, which, column) if inside else None
    return found


def _with_trust(skin: Any, part: SkinMaps) -> Any:
    from dataclasses import replace

    return replace(skin, spread=part.sigmas, sure=part.confidence)


def _colours(face: OpenFace, linear: NDArray[np.float32]) -> Reading:
    stored = from_unit(
        np.asarray(face.space.from_linear_srgb(linear[None, None]), np.float32), face.stored
    )[0, 0]
    whole = stored.dtype.kind == "u"
    return {
        "stored": [int(v) if whole else round(float(v), 4) for v in stored],
        "lab": [round(float(v), 2) for v in lab(linear)],
        "ita": round(float(ita(linear[None])[0]), 1),
    }


def _values(skin: SkinMaps, column: int) -> Reading:
    names = (*NAMES, *(name for name in RARE_NAMES if name in skin.maps.values))
    return {
        name: [
            float(skin.maps[name][0, column]),
            float(skin.sigmas[name][0, column]) if name in skin.sigmas else None,
        ]
        for name in names
    }


def _spectrum(face: OpenFace, skin: SkinMaps, column: int) -> list[float]:
    values = {name: found[:, column : column + 1] for name, found in skin.maps.values.items()}
    maps = Maps(values, skin.mask[:, column : column + 1])
    return [round(float(v), 4) for v in maps_colours.reflectance(face.model.tissue, maps)[0, 0]]


def axes() -> Reading:
    """What a page must know of wavelengths and parameters."""
    return {
        "wavelengths": [float(w) for w in WAVELENGTHS],
        "parameters": [
            {
                "name": p.name, "symbol": p.symbol, "meaning": p.meaning, "unit": p.unit,
                "low": p.low, "high": p.high, "root": p.root,
            }
            for p in map(parameter, (*NAMES, *RARE_NAMES))
        ],
    }  # fmt: skip
