"""Edits of blood and melanin, and the further ones (the paper's figures 10 and 11)."""

import numpy as np

from cutis.colour import lab
from cutis.looks.presets import preset
from cutis.report.appearance import displayed
from studies.figures.layout import grid
from studies.figures.section import Section, table
from studies.figures.subjects import Cast, Subject

LIGHT = ("blood-eighth", "blood-half", "blood-triple", "melanin-more", "melanin-triple",
         "melanin-fivefold")  # fmt: skip
DARK = ("blood-eighth", "blood-half", "blood-triple", "melanin-half", "melanin-more",
        "melanin-triple")  # fmt: skip
FURTHER = ("deoxygenated", "oxygenated", "thinnest", "thickest", "tanning", "flushing", "vitiligo")
LABELS = {
    "blood-eighth": "blood × 0.125",
    "blood-half": "blood × 0.5",
    "blood-triple": "blood × 3",
    "melanin-half": "melanin × 0.5",
    "melanin-more": "melanin × 1.5",
    "melanin-triple": "melanin × 3",
    "melanin-fivefold": "melanin × 5",
}


def edited(subject: Subject, name: str) -> np.ndarray:
    """(H, W, 3) the calibrated capture with a preset in it."""
    skin = subject.maps
    return skin.calibration.apply(skin.apply(preset(name)).albedo())


def shift(subject: Subject, colours: np.ndarray) -> np.ndarray:
    """(3,) median change of L*, a*, b* on skin."""
    inside = subject.texels
    change = lab(colours[inside]) - lab(subject.calibrated[inside])
    return np.median(change, axis=0)


def draw_grid(cast: Cast) -> Section:
    """Every subject with six edits of blood and melanin."""
    pictures, rows, signs = [], [], []
    for number, subject in enumerate(cast.subjects):
        names = LIGHT if number < 2 else DARK
        row = [displayed(subject.calibrated)]
        for name in names:
            colours = edited(subject, name)
            row.append(displayed(colours))
            change = shift(subject, colours)
            rows.append([subject.skin, LABELS[name], *(f"{v:+.1f}" for v in change)])
            if name.startswith("blood"):
                signs.append((change[1] > 0) == (name == "blood-triple"))
            else:
                signs.append((change[0] > 0) == (name == "melanin-half"))
        pictures.append(row)
    return Section(
        name="editing-grid",
        numbers={"right": sum(signs), "count": len(signs)},
        table=table(["skin", "edit", "ΔL*", "Δa*", "Δb*"], rows),
        pictures=(
            (
                grid(
                    pictures,
                    [s.skin for s in cast.subjects],
                    ["capture", "blood × 0.125", "blood × 0.5", "blood × 3",
                     "melanin × 1.5 | 0.5", "× 3 | 1.5", "× 5 | 3"],
                ),
                "Columns of melanin: the two lightest skins × 1.5, 3, 5; the others × 0.5, 1.5, 3, "
                "as in the paper.",
            ),
        ),
        credits=cast.credits,
    )  # fmt: skip


def draw_further(cast: Cast) -> Section:
    """Oxygenation, thickness, tanning, flushing and vitiligo."""
    pictures, rows = [], []
    moves: dict[str, list[np.ndarray]] = {}
    for subject in cast.subjects:
        row = [displayed(subject.calibrated)]
        for name in FURTHER:
            colours = edited(subject, name)
            row.append(displayed(colours))
            change = shift(subject, colours)
            moves.setdefault(name, []).append(change)
            rows.append([subject.skin, name, *(f"{v:+.1f}" for v in change)])
        pictures.append(row)
    tanned = [f"{change[0]:+.1f}" for change in moves["tanning"]]
    redder = sum(
        (change[1] > 0) == (name != "deoxygenated")
        for name in ("deoxygenated", "oxygenated", "flushing")
        for change in moves[name]
    )
    lighter = sum(
        (change[0] > 0) == (name == "thinnest")
        for name in ("thinnest", "thickest")
        for change in moves[name]
    )
    count = len(cast.subjects)
    return Section(
        name="further-edits",
        numbers={
            "redder": redder,
            "colours": 3 * count,
            "lighter": lighter,
            "depths": 2 * count,
            "tanned": ", ".join(tanned),
        },
        table=table(["skin", "edit", "ΔL*", "Δa*", "Δb*"], rows),
        pictures=((grid(pictures, [s.skin for s in cast.subjects], ["capture", *FURTHER], 1.1),
                   "Albedos with each edit."),),
        credits=cast.credits,
    )  # fmt: skip
