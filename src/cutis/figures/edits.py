"""Edits of blood and melanin, and the further ones (the paper's figures 10 and 11)."""

import numpy as np

from cutis.colour import lab
from cutis.figures.layout import displayed, grid
from cutis.figures.section import Section, table
from cutis.figures.subjects import Cast, Subject
from cutis.maps.presets import PRESETS

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
    return skin.calibration.apply(skin.apply(PRESETS[name]).albedo())


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
        title="Edits of blood and melanin",
        paper="Factors on blood and melanin give predictable changes for skin types I to V: more "
        "blood is redder, more melanin darker; large ones on some skins look less natural. The "
        "paper shows renders; here are albedos.",
        found=f"**Agreement for {sum(signs)} of {len(signs)} edits**: they move the median colour "
        "the "
        "way their name says (a* with blood, L* with melanin). The others are factors of blood on "
        "the darkest subjects: under so much melanin more blood darkens more than it reddens. The "
        "same factor does more to light skin; melanin × 3 on dark skin runs into the end of its "
        "range.",
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
        title="Further edits",
        paper="Oxygenation makes skin paler or more saturated; a thin epidermis shows what lies "
        "below, a thick one covers it; tanning (melanin + 40 %, all pheomelanin), flushing (blood "
        "+ 70 %, fully oxygenated) and vitiligo look as their names say.",
        found="**Agreement but for tanning.** a* rises with oxygenation and flushing and falls "
        "without "
        f"oxygen on {redder} of {3 * count}; a thin epidermis is lighter and a thick one darker on "
        f"{lighter} of {2 * count}. Tanning with the paper's amounts moves L* by only "
        f"{', '.join(tanned)}, from the lightest subject to the darkest, and b* up: pheomelanin "
        "absorbs less than the eumelanin that it replaces. `melanin × 1.5` above darkens as "
        "tanning "
        "should. Numbers are medians over skin; patches of vitiligo cover about a third of it.",
        table=table(["skin", "edit", "ΔL*", "Δa*", "Δb*"], rows),
        pictures=((grid(pictures, [s.skin for s in cast.subjects], ["capture", *FURTHER], 1.1),
                   "Albedos with each edit."),),
        credits=cast.credits,
    )  # fmt: skip
