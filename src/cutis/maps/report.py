"""What an estimate can be trusted for, in numbers."""

from typing import Any

import numpy as np

from cutis.colour import delta_e, is_skin_colour, ita
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import to_coordinates

GAMUT_DELTA_E = 1.0
"""CIEDE2000 beyond which the model does not explain a texel: it is out of gamut."""


def report(skin: SkinMaps) -> dict[str, Any]:
    """Every number that `cutis estimate` prints; needs the capture.

    Colour errors compare the model alone with the calibrated capture, on skin texels: inside the
    mask, L* > 35 and C*ab > 12. `smoothness` is the mean difference of neighbouring texels of a
    map, in network coordinates, over that of the capture (mean over R, G, B).
    """
    if skin.source is None:
        raise ValueError("a report needs the capture")
    inside = skin.mask > 0
    calibrated = skin.calibration.apply(skin.source[inside])
    modelled = skin.calibration.apply(skin.model_albedo[inside])
    texels = is_skin_colour(calibrated)
    result: dict[str, Any] = {
        "model": skin.model,
        "size": list(skin.shape),
        "masked_texels": int(inside.sum()),
        "skin_texels": int(texels.sum()),
        "calibration": {
            "gains": [round(g, 5) for g in skin.calibration.gains],
            "origin": skin.calibration.origin,
        },
        "maps": {
            name: {"unit": unit, "p5": low, "median": median, "p95": high}
            for name, unit, low, median, high in skin.statistics()
        },
    }
    if texels.any():
        truth, model = calibrated[texels], modelled[texels]
        errors = delta_e(model, truth)
        result["colour"] = {
            "mse": float(np.mean((model - truth) ** 2, dtype=np.float64)),
            "delta_e_mean": float(errors.mean()),
            "delta_e_p95": float(np.percentile(errors, 95)),
            "out_of_gamut": float(np.mean(errors > GAMUT_DELTA_E)),
            "ita_median": float(np.median(ita(truth))),
        }
        where = np.zeros(skin.shape, dtype=bool)
        where[inside] = texels
        result["smoothness"] = smoothness(skin, where)
    return result


def smoothness(skin: SkinMaps, where: np.ndarray) -> dict[str, float]:
    """Mean neighbour difference of each map over that of the capture, over texels `where`."""
    if skin.source is None:
        raise ValueError("smoothness needs the capture")
    maps = np.zeros(5)
    colour = 0.0
    along, down = where[:, 1:] & where[:, :-1], where[1:] & where[:-1]
    step = 256
    for top in range(0, skin.shape[0], step):
        rows = slice(top, top + step + 1)
        u = to_coordinates(np.where(where[rows][..., None], skin.parameters(rows), 1))
        for values, add in ((u, "maps"), (skin.source[rows], "colour")):
            sideways = np.abs(np.diff(values[:step], axis=1))[along[top : top + step]]
            downwards = np.abs(np.diff(values, axis=0))[down[top : top + step]]
            total = sideways.sum(axis=0, dtype=np.float64) + downwards.sum(axis=0, dtype=np.float64)
            if add == "maps":
                maps += total
            else:
                colour += float(total.mean())
    names = ("melanin", "blood", "thickness", "eumelanin", "oxygenation")
    return {name: float(m / colour) if colour else 0.0 for name, m in zip(names, maps, strict=True)}
