"""Writes src/cutis/data/tones/*.csv and the tables of docs/tones.md that are about it.

    python -m studies.build_tones [--model NAME]

Needs the larger data beside the project. The colours are measured ones; what a model makes of them
(`--model`, else the default) is in the page only.
"""

import sys

import numpy as np

from cutis.colour import delta_e, ita
from cutis.maps import DEFAULT, load_model
from cutis.optics import NAMES
from cutis.textures import replacing
from studies.figures.subjects import data_folder
from studies.generated import ROOT, record
from studies.pages import rewrite
from studies.tone_paths import ENDS, GRID, SITES, Path3, Sites, path_of, persons_of, read_sites

TABLES = ROOT / "src" / "cutis" / "data" / "tones"
SHOWN = (50, 40, 30, 20, 10, 0, -10, -20, -30, -40, -50)
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
HEADER = f"""\
# Measured skin over the ITA of the person's face, degrees: linear sRGB under D65 without surface
# (red, green, blue); covariances of log RGB between persons (b_..) and within a face (w_..); the
# standard deviation of ITA within a face (spread, degrees); persons that count (persons).
# Units: ita and spread in degrees, colours and covariances without.
# Local lines, Gaussian of 8 degrees; beyond {ENDS[0]:g} and {ENDS[1]:g} the last line goes on.
# Source: ISSA, half A, key issa2025, CC BY 4.0. Made by python -m studies.build_tones.
"""
KEYS = tuple("rgb"[i] + "rgb"[j] for i, j in PAIRS)


def write(paths: dict[str, Path3]) -> None:
    """The tables of the package."""
    columns = ["ita", "red", "green", "blue", *(f"b_{k}" for k in KEYS),
               *(f"w_{k}" for k in KEYS), "spread", "persons"]  # fmt: skip
    TABLES.mkdir(exist_ok=True)
    for site, path in paths.items():
        lines = [f"# The {site}.", HEADER + ",".join(columns)]
        for i, tone in enumerate(GRID):
            numbers = [
                *np.exp(path.colours[i]), *(path.between[i][p] for p in PAIRS),
                *(path.within[i][p] for p in PAIRS), path.spread[i], path.count[i],
            ]  # fmt: skip
            lines.append(",".join([f"{tone:g}", *(f"{n:.5g}" for n in numbers)]))
        with replacing(TABLES / f"{site}.csv") as partial:
            partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
    record(*(TABLES / f"{site}.csv" for site in paths))


def parameters_table(paths: dict[str, Path3], model: str) -> str:
    """What a model makes of the face's path."""
    used = load_model(model)
    rows = ["| ITA° | red | green | blue | " + " | ".join(NAMES) + " | spread, log RGB | persons |",
            "|---" * (6 + len(NAMES)) + "|"]  # fmt: skip
    face = paths["face"]
    for tone in SHOWN:
        i = int(np.argmin(abs(GRID - tone)))
        rgb = np.exp(face.colours[i])
        skin = used.encode(rgb[None].astype(np.float32))[0]
        spread = ", ".join(f"{v:.3f}" for v in np.sqrt(np.diag(face.within[i])))
        cells = [f"{tone}", *(f"{v:.3f}" for v in rgb), *(f"{v:.3g}" for v in skin), spread,
                 f"{face.count[i]:.0f}"]  # fmt: skip
        rows.append("| " + " | ".join(cells) + " |")
    return f"Parameters as `{model}` finds them in the path's colours.\n\n" + "\n".join(rows)


def halves_table(paths: dict[str, Path3], data: Sites) -> str:
    """How far paths of two halves of the persons lie apart, and the sites of one person."""
    names = np.unique(data.persons)
    halves = []
    for part in (names[::2], names[1::2]):
        some = data.some(np.isin(data.persons, part))
        people = persons_of(some)
        halves.append({site: path_of(some, people, site) for site in SITES})
    rows = ["| ITA° of the face | " + " | ".join(f"{s}: ITA° | halves, ΔE00" for s in SITES) + " |",
            "|---" * (1 + 2 * len(SITES)) + "|"]  # fmt: skip
    for tone in SHOWN:
        i = int(np.argmin(abs(GRID - tone)))
        cells = []
        for site in SITES:
            one, two = (np.exp(half[site].colours[i]) for half in halves)
            apart = float(delta_e(one, two))
            cells.append(f"{float(ita(np.exp(paths[site].colours[i]))):.0f} | {apart:.2f}")
        rows.append(f"| {tone} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def main() -> None:
    model = sys.argv[sys.argv.index("--model") + 1] if "--model" in sys.argv else DEFAULT
    data = data_folder(None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder in CUTIS_SHARED_DATA")
    sites = read_sites(data)
    people = persons_of(sites)
    paths = {site: path_of(sites, people, site) for site in SITES}
    write(paths)
    rewrite("tones.md", path=parameters_table(paths, model), halves=halves_table(paths, sites))


if __name__ == "__main__":
    main()
