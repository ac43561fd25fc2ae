"""Palettes of the albedo space (the paper's figure 3)."""

import numpy as np

from cutis.albedo import albedo_space
from cutis.colour import delta_e
from cutis.optics import ALIAGA2022, NAMES, parameter
from cutis.report.appearance import displayed
from studies.figures.layout import grid
from studies.figures.section import Section, table
from studies.figures.subjects import Cast

STEPS = 32
"""Colours along melanin and along blood."""
MELANIN, BLOOD = (0.001, 0.43), (0.001, 0.30)
"""The part of the ranges that the paper shows."""
MIDDLE = {"thickness": 100.0, "eumelanin": 0.5, "oxygenation": 0.75}
ENDS = {
    "thickness": (10.0, 100.0, 250.0),
    "eumelanin": (0.001, 0.5, 1.0),
    "oxygenation": (0.0, 0.5, 0.999),
}


def palette(**held: float) -> np.ndarray:
    """(STEPS, STEPS, 3) linear sRGB, melanin rising downwards and blood to the right."""
    melanin, blood = (
        np.linspace(low ** (1 / p.root), high ** (1 / p.root), STEPS) ** p.root
        for p, (low, high) in ((parameter("melanin"), MELANIN), (parameter("blood"), BLOOD))
    )
    skins = np.empty((STEPS, STEPS, 5))
    skins[..., 0], skins[..., 1] = melanin[:, None], blood
    for name, value in (MIDDLE | held).items():
        skins[..., NAMES.index(name)] = value
    return albedo_space(ALIAGA2022).rgb(skins)


def draw(cast: Cast) -> Section:
    """A palette for three values of each of the other parameters."""
    pictures, rows = [], []
    numbers: dict[str, float] = {}
    for name, values in ENDS.items():
        colours = [palette(**{name: value}) for value in values]
        pictures.append([displayed(c).repeat(6, 0).repeat(6, 1) for c in colours])
        error = delta_e(colours[0], colours[-1])
        light, dark = error[: STEPS // 4], error[-STEPS // 4 :]
        numbers[name] = error.mean()
        if name == "oxygenation":
            numbers |= {"light": light.mean(), "dark": dark.mean()}
        unit = parameter(name).unit.replace("1", "")
        rows.append(
            [name, f"{values[0]:g} to {values[-1]:g} {unit}".strip(), f"{error.mean():.1f}",
             f"{light.mean():.1f}", f"{dark.mean():.1f}", f"{error.max():.1f}"]
        )  # fmt: skip
    return Section(
        name="palettes",
        numbers=numbers,
        table=table(
            ["parameter", "from, to", "ΔE00 mean", "least melanin", "most melanin", "max"], rows
        ),
        pictures=(
            (
                grid(pictures, list(ENDS), ["lowest", "middle", "highest"], 1.6),
                "Melanin rises downwards, blood to the right; a row per parameter that is varied, "
                "the others at 100 µm, 0.5 and 0.75.",
            ),
        ),
    )
