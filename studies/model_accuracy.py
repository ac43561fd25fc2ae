"""Rewrites the tables of docs/models.md: run `python -m studies.model_accuracy`.

Closed loop and smoothness of every model on the bundled capture and on every texture of the shared
data (skipped, saying so, where it is absent), and recovery of uniform skins.
"""

from pathlib import Path

import numpy as np
from rich.progress import track

from cutis import estimate, read, read_mask
from cutis.albedo import albedo_space, uniform
from cutis.colour import delta_e, is_skin_colour
from cutis.maps import load_model
from cutis.optics import NAMES, to_coordinates
from cutis.report import gathering as report
from studies.figures.subjects import data_folder
from studies.pages import rewrite

ROOT = Path(__file__).parents[1]
MODELS = ("measured2026", "aliaga2022-exact", "aliaga2022")
TENSORS = ("lookup", "lookup-55k")
"""Compared in the closed loop only."""
ORDER = ("melanin", "blood", "thickness", "oxygenation", "eumelanin")
SKINS = 120_000


def textures() -> list[tuple[Path, Path | None]]:
    """Capture and mask of every texture at hand, the bundled one first."""
    examples = ROOT / "examples"
    found = [(examples / "bioskin_capture1.jpg", examples / "bioskin_capture1_mask.jpg")]
    folder = data_folder(None)
    if folder is None:
        print("the shared data is absent: only the bundled capture")
        return found
    head = folder / "albedo" / "makehuman_head_mask.png"
    for path in sorted((folder / "albedo").glob("*.*g")):
        if "mask" not in path.name and path.name != found[0][0].name:
            found.append((path, head if path.name.startswith("makehuman") else None))
    return found


def closed_loop() -> tuple[str, str]:
    """Colour errors per texture, and smoothness on the bundled capture."""
    rows = ["| texture | model | gains | MSE | ΔE00 mean | p95 | out of gamut | ITA |",
            "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    smooth = ["| model | " + " | ".join(ORDER) + " |", "|---|---|---|---|---|---|"]
    for path, mask_path in track(textures(), "closed loop"):
        face = read(path)
        mask = None if mask_path is None else read_mask(mask_path, face.shape)
        automatic = {  # the gains are those that suit the tissue
            load_model(model).tissue: estimate(
                face, mask, white="auto", model=model
            ).calibration.gains
            for model in MODELS[:2]
        }
        runs = [(automatic[load_model(model).tissue], model) for model in (*MODELS, *TENSORS)]
        runs += [((1.0, 1.0, 1.0), model) for model in MODELS[:2]]
        for gains, model in runs:
            found = report(estimate(face, mask, white=gains, model=model))
            label = "none" if gains == (1.0, 1.0, 1.0) else " ".join(f"{g:.2f}" for g in gains)
            colour = found.get("colour")
            if colour is None:
                rows.append(f"| {path.stem} | {model} | {label} | no skin colour | | | | |")
                continue
            rows.append(
                f"| {path.stem} | {model} | {label} | {colour['mse']:.1e} "
                f"| {colour['delta_e_mean']:.3f} | {colour['delta_e_p95']:.3f} "
                f"| {100 * colour['out_of_gamut']:.2f} % | {colour['ita_median']:.0f}° |"
            )
            if label != "none" and path.stem == "bioskin_capture1":
                cells = " | ".join(f"{found['smoothness'][n]:.2f}" for n in ORDER)
                smooth.append(f"| {model} | {cells} |")
    return "\n".join(rows), "\n".join(smooth)


def recovery() -> str:
    """R² of each parameter, in network coordinates, over uniform skins of the model's tissue."""
    skins = uniform(SKINS, 2023)
    truth = to_coordinates(skins)
    rows = ["| model | over | " + " | ".join(ORDER) + " | ΔE00 mean | p95 |", "|---|" + "---|" * 8]
    for name in MODELS:
        model = load_model(name)
        rgb = albedo_space(model.tissue).rgb(skins)
        skin_coloured = is_skin_colour(rgb)
        found = model.encode(rgb)
        errors = delta_e(model.decode(found), rgb)
        squares = (to_coordinates(found) - truth) ** 2
        for label, these in (("all", slice(None)), ("skin colours", skin_coloured)):
            r2 = 1 - squares[these].mean(0) / truth[these].var(0)
            cells = " | ".join(f"{r2[NAMES.index(n)]:.3f}" for n in ORDER)
            mean, high = errors[these].mean(), np.percentile(errors[these], 95)
            rows.append(f"| {name} | {label} | {cells} | {mean:.3f} | {high:.3f} |")
    return "\n".join(rows)


def main() -> None:
    rewrite("models.md", recovery=recovery())
    loop, smooth = closed_loop()
    rewrite("models.md", loop=loop, smooth=smooth)


if __name__ == "__main__":
    main()
