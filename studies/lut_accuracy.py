"""Rewrites the tables of docs/lut.md: run `python -m studies.lut_accuracy`.

Every face of the shared data, white-balanced, through LUT files as OpenColorIO reads them, against
estimate, edit and albedo of the same colours. A LUT of 65 nodes a side for each face's calibration.
"""

import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from rich.progress import track

from cutis.colour import delta_e, is_skin_colour
from cutis.colour.spaces import rgb_space
from cutis.looks.presets import preset
from cutis.luts import export_lut
from cutis.maps import estimate
from studies.figures.subjects import data_folder, every_face
from studies.pages import rewrite

SOME = ["tanning", "flushing", "melanin-triple", "blood-half", "deoxygenated", "thinnest"]
FEW = ["tanning", "flushing", "melanin-triple"]
"""Presets that a .cube is tried with: its nodes take ten seconds to fit."""
TRIED = {"clf": SOME, "cube": FEW}
SPACES = ("sRGB", "ACEScg")
COLOURS = 1500


def through(file: Path, stored: np.ndarray) -> np.ndarray:
    """(n, 3) values through a LUT file."""
    image = oiio.ImageBuf(oiio.ImageSpec(len(stored), 1, 3, "float"))
    image.set_pixels(oiio.ROI(), stored[None].astype(np.float32))
    return oiio.ImageBufAlgo.ociofiletransform(image, str(file)).get_pixels(oiio.FLOAT)[0]


def row(kind: str, space_name: str, skin, colours: np.ndarray, folder: Path) -> list[float]:
    """ΔE00 at the 99th percentile of each preset."""
    space = rgb_space(space_name)
    found = []
    for name in TRIED[kind]:
        # a name of its own: OpenColorIO remembers files that it has read
        file = Path(tempfile.mkstemp(f".{kind}", dir=folder)[1])
        export_lut(file, preset(name), space, calibration=skin.calibration)
        result = space.to_linear_srgb(through(file, space.from_linear_srgb(colours)))
        file.unlink()
        real = skin.apply(preset(name)).albedo()[0]
        found.append(float(np.percentile(delta_e(result, real), 99)))
    return found


def main() -> None:
    faces = list(every_face(data_folder(None), COLOURS))
    names = {(k, s): f"{k}-{s.lower()}" for k in TRIED for s in SPACES}
    tables = {
        names[k, s]: [
            f"| face | skin colours | {' | '.join(TRIED[k])} |",
            "|---" * (len(TRIED[k]) + 2) + "|",
        ]
        for k, s in names
    }
    with tempfile.TemporaryDirectory() as folder:
        for face, colours in track(faces, "faces"):
            skin = estimate(colours[None], white="auto")
            share = 100 * is_skin_colour(colours).mean()
            for (kind, space), name in names.items():
                values = row(kind, space, skin, colours, Path(folder))
                cells = " | ".join(f"**{v:.2f}**" if v > 0.5 else f"{v:.2f}" for v in values)
                tables[name].append(f"| {face.replace('_', ' ')} | {share:.0f} % | {cells} |")
    rewrite("lut.md", **{name: "\n".join(rows) for name, rows in tables.items()})


if __name__ == "__main__":
    main()
