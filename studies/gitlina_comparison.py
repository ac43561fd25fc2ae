"""Rewrites the tables of other tissues in docs/models.md: `python -m studies.gitlina_comparison`.

Gitlina et al. 2020 beside `aliaga2022`: both tissues, and steps between them, through the same
fit. Measured skins and most faces are in the larger data beside the project, whose folder may be
named as the only argument.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import track

from cutis.colour import delta_e, ita, reflectance_to_rgb
from cutis.inverse import explain
from cutis.optics import ALIAGA2022, GITLINA2020, Tissue
from cutis.report.gathering import GAMUT_DELTA_E
from studies.figures.measured import BANDS, measured_skins
from studies.figures.subjects import data_folder, every_face
from studies.pages import rewrite

MOST = 30_000
"""Skin texels of a face."""
END = 0.02
"""Coordinates this near to 0 or 1 count as the end of a range."""
STEPS: dict[str, Tissue] = {
    "`aliaga2022`": ALIAGA2022,
    "its oxygenation held at 0.75": replace(ALIAGA2022, name="a1", fixed=(("oxygenation", 0.75),)),
    "its thickness held at 250 µm": replace(ALIAGA2022, name="a2", fixed=(("thickness", 250.0),)),
    "both held": replace(ALIAGA2022, name="a3", fixed=GITLINA2020.fixed),
    "`gitlina2020`": GITLINA2020,
    "its epidermis without blood": replace(GITLINA2020, name="g1", epidermal_blood=False),
    "its boundary matched": replace(GITLINA2020, name="g2", boundary="matched"),
    "its transport that of `aliaga2022`, flatland and matched": replace(
        GITLINA2020, name="g3", boundary="matched", dimension=2
    ),
    "its thickness 100 µm": replace(
        GITLINA2020, name="g4", fixed=(("thickness", 100.0), ("oxygenation", 0.75))
    ),
}
ITA = ((55, 999, "very light"), (41, 55, "light"), (28, 41, "intermediate"), (10, 28, "tan"),
       (-30, 10, "brown"), (-999, -30, "dark"))  # fmt: skip


def cells(model: np.ndarray, colours: np.ndarray) -> str:
    """MSE, ΔE00 mean and 95th percentile, share out of gamut."""
    error = delta_e(model, colours)
    return (
        f"{np.mean((model - colours) ** 2):.1e} | {error.mean():.2f} "
        f"| {np.percentile(error, 95):.2f} | {100 * np.mean(error > GAMUT_DELTA_E):.1f} %"
    )


def at_ends(tissue: Tissue, maps: dict[str, np.ndarray]) -> str:
    """Parameters whose coordinate is within END of an end of its range for a tenth of skins."""
    found = []
    for known in tissue.parameters:
        u = known.to_coordinate(maps[known.name])
        for share, which in ((np.mean(u < END), "low"), (np.mean(u > 1 - END), "high")):
            if share > 0.1:
                found.append(f"{known.name} {which} {100 * share:.0f} %")
    return ", ".join(found)


def compared(label: str, colours: np.ndarray) -> list[str]:
    """A row: one colour for all texels, then both tissues."""
    flat = np.mean((colours - colours.mean(axis=0)) ** 2)
    both = [cells(explain(colours, t)[1], colours) for t in (ALIAGA2022, GITLINA2020)]
    return [f"| {label} | {np.median(ita(colours)):.0f}° | {flat:.1e} | {both[0]} | {both[1]} |"]


def main() -> None:
    data = data_folder(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder")
    head = [
        "| skin | ITA° | one colour: MSE | `aliaga2022`: MSE | ΔE00 mean | p95 | out of gamut "
        "| `gitlina2020`: MSE | ΔE00 mean | p95 | out of gamut |",
        "|---" * 11 + "|",
    ]
    faces = list(head)
    for name, colours in track(list(every_face(data, MOST)), "faces"):
        faces += compared(name, colours)
    skins = reflectance_to_rgb(measured_skins(data), BANDS).astype(np.float32)
    angles = ita(skins)
    measured = [*head, *compared(f"all {len(skins)} measured", skins)]
    for low, high, label in track(ITA, "measured skins"):
        some = skins[(angles > low) & (angles <= high)]
        measured += compared(f"{label} ({len(some)})", some)
    steps = [
        "| tissue | free | MSE | ΔE00 mean | p95 | out of gamut | at the end of a range |",
        "|---" * 7 + "|",
    ]
    for label, tissue in track(STEPS.items(), "steps"):
        maps, model = explain(skins, tissue)
        ends = at_ends(tissue, maps)
        steps.append(f"| {label} | {len(tissue.parameters)} | {cells(model, skins)} | {ends} |")
    rewrite(
        "models.md",
        gitlina_faces="\n".join(faces),
        gitlina_measured="\n".join(measured),
        gitlina_steps="\n".join(steps),
    )


if __name__ == "__main__":
    main()
