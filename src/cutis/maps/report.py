"""What an estimate can be trusted for, in numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.colour import delta_e, is_skin_colour, ita
from cutis.errors import CutisError
from cutis.maps.skin_maps import SkinMaps
from cutis.optics import NAMES, to_coordinates
from cutis.textures.texture import bands

GAMUT_DELTA_E = 1.0
"""CIEDE2000 beyond which the model does not explain a texel: it is out of gamut."""


def report(skin: SkinMaps) -> dict[str, Any]:
    """Every number that `cutis estimate` prints; needs the capture.

    Colour errors compare the model alone with the calibrated capture, on skin texels: inside the
    mask, L* > 35 and C*ab > 12; without any, `colour` and `smoothness` are left out. `smoothness`
    is the mean difference of neighbouring texels of a map, in network coordinates, over that of
    the capture (mean over R, G, B). `below_0` and `above_1` count texels inside the mask with a
    colour that is no albedo.
    """
    if skin.source is None:
        raise CutisError("a report needs the capture; read it and estimate again")
    where = np.zeros(skin.shape, dtype=bool)
    errors, angles = [], []
    squares, masked, below, above = 0.0, 0, 0, 0
    for rows in bands(skin.shape):
        inside = skin.mask[rows] > 0
        source = skin.source[rows][inside]
        masked += len(source)
        below += int(np.count_nonzero((source < 0).any(axis=1)))
        above += int(np.count_nonzero((source > 1).any(axis=1)))
        truth = skin.calibration.apply(source)
        texels = is_skin_colour(truth)
        where[rows][inside] = texels
        truth = truth[texels]
        model = skin.calibration.apply(skin.model_albedo[rows][inside][texels])
        squares += float(np.sum((model - truth) ** 2, dtype=np.float64))
        errors.append(delta_e(model, truth))
        angles.append(ita(truth))
    result: dict[str, Any] = {
        "model": skin.model,
        "size": list(skin.shape),
        "masked_texels": masked,
        "skin_texels": int(where.sum()),
        "below_0": below,
        "above_1": above,
        "calibration": {
            "gains": [round(g, 5) for g in skin.calibration.gains],
            "origin": skin.calibration.origin,
            "illuminant": skin.calibration.light,
        },
        "maps": {
            name: {"unit": unit, "p5": low, "median": median, "p95": high}
            for name, unit, low, median, high in skin.statistics()
        },
    }
    if where.any():
        error = np.concatenate(errors)
        result["colour"] = {
            "mse": squares / (3 * error.size),
            "delta_e_mean": float(error.mean(dtype=np.float64)),
            "delta_e_p95": float(np.percentile(error, 95)),
            "out_of_gamut": float(np.mean(error > GAMUT_DELTA_E)),
            "ita_median": float(np.median(np.concatenate(angles))),
        }
        result["smoothness"] = smoothness(skin, where)
    return result


def smoothness(skin: SkinMaps, where: NDArray[np.bool_]) -> dict[str, float]:
    """Mean neighbour difference of each map over that of the capture, over texels `where`."""
    if skin.source is None:
        raise CutisError("smoothness needs the capture; read it and estimate again")
    maps, colour = np.zeros(5), np.zeros(3)
    for rows in bands(skin.shape):
        more = slice(rows.start, rows.stop + 1)  # the next row, for the differences downwards
        here = where[more]
        along, down = here[:, 1:] & here[:, :-1], here[1:] & here[:-1]
        along = along[: rows.stop - rows.start]
        u = to_coordinates(np.where(here[..., None], skin.parameters(more), 1))
        for values, total in ((u, maps), (skin.source[more], colour)):
            sideways = np.abs(np.diff(values[: len(along)], axis=1))[along]
            downwards = np.abs(np.diff(values, axis=0))[down]
            total += sideways.sum(axis=0, dtype=np.float64)
            total += downwards.sum(axis=0, dtype=np.float64)
    base = float(colour.mean())
    return {name: float(m / base) if base else 0.0 for name, m in zip(NAMES, maps, strict=True)}
