"""Draws docs/images/steady.jpg: run `python -m studies.steady_picture`, with the shared data.

Melanin type of a light, a brown and a dark face with neighbours and without, and edits of it.
"""

import numpy as np
from matplotlib.figure import Figure

from cutis import estimate, read, read_mask
from cutis.colour.transfer import encode_srgb
from cutis.inverse.shipped import MEASURED, VARYING
from cutis.textures import replacing
from studies.figures.subjects import data_folder
from studies.generated import record
from studies.pages import DOCS

FACES = (
    ("makehuman_middleage_light_male_head.png", "light"),
    ("makehuman_african_middleage_mindfront_head.png", "brown"),
    ("makehuman_young_dark_male_head.png", "dark"),
)
COLUMNS = (
    "capture", "type, `off`", "type", "`b`: type, `off`", "`b`: type", "`b`: type 0, `off`",
    "`b`: type 0", "`b`: thinnest, `off`", "`b`: thinnest",
)  # fmt: skip
EDGE = 320
"""Texels of a crop along an edge."""


def main() -> None:
    data = data_folder(None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder in CUTIS_SHARED_DATA")
    figure = Figure(figsize=(18, 6.6), dpi=90, layout="constrained")
    panels = figure.subplots(len(FACES), len(COLUMNS))
    for row, (name, skin) in zip(panels, FACES, strict=True):
        face = read(data / "albedo" / name)
        mask = read_mask(data / "albedo" / "makehuman_head_mask.png", face.shape)
        rows, columns = np.nonzero(mask > 0.5)
        top, left = int(np.median(rows)) - EDGE // 2, int(np.median(columns)) - EDGE // 2
        crop = np.s_[top : top + EDGE, left : left + EDGE]
        pictures = [face.linear()]
        for model in (MEASURED, VARYING):
            found = [
                estimate(face, mask, white="auto", model=model, steady=steady)
                for steady in (False, True)
            ]
            pictures += [maps.eumelanin for maps in found]
        pictures += [maps.replace(eumelanin=0.001).albedo() for maps in found]
        pictures += [maps.replace(thickness=10).albedo() for maps in found]
        for axes, picture, title in zip(row, pictures, COLUMNS, strict=True):
            if picture.ndim == 3:
                axes.imshow(np.clip(encode_srgb(picture[crop]), 0, 1))
            else:
                axes.imshow(picture[crop], cmap="magma", vmin=0, vmax=1)
            axes.set_xticks([])
            axes.set_yticks([])
            if skin == FACES[0][1]:
                axes.set_title(title.replace("`", ""), fontsize=9)
        row[0].set_ylabel(skin)
    target = DOCS / "images" / "steady.jpg"
    with replacing(target) as partial:
        figure.savefig(partial, format="jpg", pil_kwargs={"quality": 88})
    record(target)


if __name__ == "__main__":
    main()
