"""Rewrites the table of docs/models.md on baking: run `python tools/baked_accuracy.py`.

The baked inverse against the fit that it holds, and its decoder against the exact space, on the
texels of every texture at hand, gains found by `calibrate`.
"""

import numpy as np
from pages import rewrite
from rich.progress import track

from cutis.albedo import albedo_space
from cutis.colour import delta_e
from cutis.figures.subjects import data_folder, every_face
from cutis.inverse import calibrate, load_model
from cutis.inverse.baked import PRECISION, TOLERANCE
from cutis.inverse.fit import fit
from cutis.inverse.models import shipped_encoder
from cutis.optics import from_coordinates

TEXELS = 4000
IN_GAMUT = 0.5
"""ΔE00 within which the fit has to come for a texel to be one that the tissue has."""


def baked() -> str:
    lines = [
        "| texture | in gamut | inverse against the fit: ΔE00 mean | p99 | all texels: p99 "
        "| decoder against the exact space: p99 |",
        "|---|---|---|---|---|---|",
    ]
    model, encoder, space = load_model("aliaga2022-exact"), shipped_encoder(), albedo_space()
    for name, captured in track(list(every_face(data_folder(None), TEXELS)), "baked"):
        gains = np.array(calibrate(captured, white="auto").gains)
        colours = (captured * gains).astype(np.float32)
        u = fit(space, colours, encoder(colours), np.diag(PRECISION), TOLERANCE)
        fitted, skins = space.rgb(from_coordinates(u)), model.encode(colours)
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
    rewrite("models.md", baked=baked())
