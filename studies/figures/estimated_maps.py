"""Estimated maps (the paper's figure 9)."""

import numpy as np

from cutis.optics import PARAMETERS
from cutis.report.appearance import COLOUR_MAPS, displayed
from studies.figures.layout import Picture, grid
from studies.figures.section import Section, table
from studies.figures.subjects import Cast


def draw(cast: Cast) -> Section:
    """The five maps of every subject."""
    rows, medians = [], []
    pictures: list[list[Picture]] = []
    for subject in cast.subjects:
        row: list[Picture] = [displayed(subject.calibrated)]
        cells = [subject.skin]
        for known in PARAMETERS:
            values = getattr(subject.maps, known.name)
            inside = values[subject.texels]
            low, middle, high = np.percentile(inside, [2, 50, 98])
            root = 1 / known.root
            shown = np.where(subject.mask > 0, values**root, np.nan)
            row.append((shown, COLOUR_MAPS[known.name], low**root, max(high, low + 1e-9) ** root))
            cells.append(f"{middle:.3g} ({low:.3g}–{high:.3g})")
            if known.name == "melanin":
                medians.append(middle)
        pictures.append(row)
        rows.append(cells)
    return Section(
        name="estimated-maps",
        numbers={"medians": ", ".join(f"{100 * m:.1f} %" for m in medians)},
        table=table(
            ["skin", *(f"{p.name} [{p.unit}]" if p.unit != "1" else p.name for p in PARAMETERS)],
            rows,
        ),
        pictures=(
            (
                grid(pictures, [s.skin for s in cast.subjects],
                     ["capture", *(p.name for p in PARAMETERS)]),
                "Maps of aliaga2022-exact; each from its 2nd to its 98th percentile (in the "
                "table: median and these).",
            ),
        ),
        credits=cast.credits,
    )  # fmt: skip
