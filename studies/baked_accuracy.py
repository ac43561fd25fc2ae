"""Rewrites the tables of docs/models.md on baking: run `python -m studies.baked_accuracy`.

The baked inverses against the fits that they hold, and their decoders against the exact space, on
the texels of every texture at hand, gains found by `calibrate`.
"""

import numpy as np
from rich.progress import track

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.colour import delta_e
from cutis.inverse import calibrate
from cutis.inverse.baked import Solver, exact_inverse, probable_skins
from cutis.inverse.model import Model
from cutis.inverse.shipped import EXACT, MEASURED, shipped_encoder, shipped_prior
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, from_coordinates
from studies.figures.subjects import data_folder, every_face
from studies.pages import rewrite

TEXELS = 4000
IN_GAMUT = 0.5
"""ΔE00 within which the fit has to come for a texel to be one that the tissue has."""


def baked(model: Model, space: AlbedoSpace, solve: Solver) -> str:
    lines = [
        "| texture | in gamut | inverse against the fit: ΔE00 mean | p99 | all texels: p99 "
        "| decoder against the exact space: p99 |",
        "|---|---|---|---|---|---|",
    ]
    for name, captured in track(list(every_face(data_folder(None), TEXELS)), model.name):
        gains = np.array(calibrate(captured, model.tissue, white="auto").gains)
        colours = (captured * gains).astype(np.float32)
        fitted, skins = space.rgb(from_coordinates(solve(colours))), model.encode(colours)
        inside = delta_e(fitted, colours) < IN_GAMUT
        exact = space.rgb(skins)
        error, decoder = delta_e(fitted, exact), delta_e(exact, model.decode(skins))
        lines.append(
            f"| {name} | {100 * inside.mean():.0f} % | {error[inside].mean():.3f} "
            f"| {np.percentile(error[inside], 99):.3f} | {np.percentile(error, 99):.3f} "
            f"| {np.percentile(decoder, 99):.4f} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    model, space = load_model(EXACT), albedo_space(ALIAGA2022)
    rewrite("models.md", baked=baked(model, space, exact_inverse(shipped_encoder(), space)))
    model = load_model(MEASURED)
    space = albedo_space(model.tissue)
    solve = probable_skins(shipped_prior(), space)
    rewrite("models.md", baked_measured=baked(model, space, solve))
