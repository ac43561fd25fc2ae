"""From maps to colours: what the model gives, and what edits make of a capture.

What a model does not explain of a texel rides along: an edit multiplies its colour by the model's
albedo after the edit over that before (docs/decisions/0004), so that texels without a change stay
what they were, bit for bit.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cutis.colour import LightLike
from cutis.inverse.calibration import Calibration
from cutis.inverse.model import Model
from cutis.maps.exact import exact
from cutis.maps.plain import Map, Maps
from cutis.maps.relighting import DARKEST, Relighting
from cutis.optics import NAMES, RARE_NAMES, Tissue
from cutis.textures.texture import bands


def model_albedo(model: Model, calibration: Calibration, maps: Maps) -> Map:
    """(H, W, 3) linear sRGB that the model alone gives, calibration undone; 0 off the mask."""
    result = np.zeros((*maps.shape, 3), dtype=np.float32)
    for rows in bands(maps.shape):
        part = maps.rows(rows)
        inside = part.mask > 0
        skins = part.parameters(maps.names)[inside]
        result[rows][inside] = calibration.undo(model.decode(skins))
    result.flags.writeable = False  # it is kept
    return result


def changes(
    model: Model, calibration: Calibration, before: Maps, after: Maps, source: Map
) -> tuple[NDArray[np.bool_], Map]:
    """Texels (h, W) of some rows that edits changed, and the colours (h, W, 3) of all."""
    names = (*NAMES, *RARE_NAMES) if after.rare or before.rare else NAMES
    result = np.array(source, dtype=np.float32)
    changed = np.zeros(before.shape, dtype=bool)
    for name in names:
        old, new = before[name], after[name]
        if old.ctypes.data != new.ctypes.data:
            changed |= old != new
    changed &= before.mask > 0
    both = np.concatenate(
        [np.stack([maps[name][changed] for name in names], axis=-1) for maps in (after, before)]
    )
    decoded = captured(model, calibration, both)
    count = len(both) // 2
    ratio = decoded[:count] / np.maximum(decoded[count:], DARKEST)
    cover = before.mask[changed][:, None]
    result[changed] *= 1 + cover * (ratio - 1)
    return changed, result


def captured(model: Model, calibration: Calibration, skins: Map) -> Map:
    """(n, 5 or 8) skins → (n, 3) colours under the light of the capture, gains left."""
    found = model.decode(skins)
    if calibration.conversion is None:
        return found
    return replace(calibration, gains=(1.0, 1.0, 1.0)).undo(found)


def residual(source: Map, albedo: Map, mask: Map) -> Map:
    """(H, W, 3) capture over the model's `albedo`, 1 off the mask."""
    result = np.ones_like(source)
    inside = mask > 0
    result[inside] = source[inside] / np.maximum(albedo[inside], DARKEST)
    return result


def reflectance(tissue: Tissue, maps: Maps) -> Map:
    """(H, W, 41) reflectance of the exact albedo space, 0 off the mask."""
    space, skins = exact(tissue, maps)
    spectra = space.reflectance(skins)
    result = np.zeros((*maps.shape, spectra.shape[-1]), dtype=np.float32)
    result[maps.mask > 0] = spectra
    return result


def relighting(
    model: Model, calibration: Calibration, light: LightLike | None
) -> Relighting | None:
    """How to relight; None where the light is that of the capture."""
    found = None if light is None else Relighting(calibration, model.tissue, light)
    return found if found is not None and found.changes else None


def alone(
    model: Model, calibration: Calibration, maps: Maps, light: LightLike | None
) -> Map | None:
    """(H, W, 3) what the model alone gives under a light; None for the light of the capture."""
    found = relighting(model, calibration, light)
    return None if found is None else found.alone(maps)
