"""The baselines: Kubelka–Munk (supplement, figure 4) and Gitlina et al. 2020 (figures 6 and 7)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.colour import delta_e, ita, reflectance_to_rgb
from cutis.inverse import explain
from cutis.inverse.shipped import EXACT
from cutis.optics import ALIAGA2022, GITLINA2020, PARAMETERS
from cutis.report.appearance import COLOUR_MAPS, displayed
from studies.figures.layout import Picture, grid, magnified
from studies.figures.measured import BANDS, measured_skins
from studies.figures.section import Section, table
from studies.figures.subjects import Cast, Subject, every_face

MOST = 40_000
"""Texels of a face that numbers are taken on."""
TISSUES = {"gitlina2020": GITLINA2020, "aliaga2022": ALIAGA2022}
ITA_BANDS = ((55, 999, "very light"), (41, 55, "light"), (28, 41, "intermediate"),
             (10, 28, "tan"), (-30, 10, "brown"), (-999, -30, "dark"))  # fmt: skip


def _errors(model: NDArray[np.floating], truth: NDArray[np.floating]) -> list[str]:
    distance = delta_e(model, truth)
    return [f"{np.mean((model - truth) ** 2):.1e}", f"{distance.mean():.2f}",
            f"{np.percentile(distance, 95):.2f}"]  # fmt: skip


def draw_kubelka_munk(cast: Cast) -> Section:
    """A light and a darker face through the two-parameter baseline."""
    pictures, rows, ratios = [], [], []
    for subject in (cast.subjects[0], cast.subjects[-1]):
        source, inside = subject.calibrated, subject.texels
        row: list[Picture] = [displayed(source)]
        squares = []
        for name in ("kubelka-munk", EXACT):
            skin = subject.maps_by(name)
            model = skin.calibration.apply(skin.model_albedo)
            error = np.where(subject.mask[..., None] > 0, model - source, 0)
            if name == "kubelka-munk":
                row += [displayed(model), magnified(error)]
                for known in PARAMETERS[:2]:
                    values = getattr(skin, known.name) ** (1 / known.root)
                    low, high = (float(v) for v in np.percentile(values[inside], [2, 98]))
                    shown = np.where(subject.mask > 0, values, np.nan)
                    row.append((shown, COLOUR_MAPS[known.name], low, high))
            squares.append(float(np.mean((model - source)[inside] ** 2)))
            rows.append([subject.skin, name, *_errors(model[inside], source[inside])])
        ratios.append(squares[0] / squares[1])
        pictures.append(row)
    return Section(
        name="kubelka-munk",
        numbers={"light": ratios[0], "dark": ratios[-1]},
        table=table(["skin", "model", "MSE", "ΔE00 mean", "p95"], rows),
        pictures=(
            (
                grid(pictures, ["light", "dark"],
                     ["capture", "Kubelka–Munk", "error × 4", "melanin", "blood"], 1.5),
                "Capture after white balance, reconstruction, four times its error in linear "
                "RGB, the two maps.",
            ),
        ),
        credits=cast.credits,
    )  # fmt: skip


def draw_gitlina(cast: Cast) -> Section:
    """Both tissues through the same machinery, on every face and on measured skins."""
    rows, wins, total = [], 0, 0
    for name, colours in every_face(cast.data, MOST):
        squares = []
        for label, tissue in TISSUES.items():
            model = explain(colours, tissue)[1]
            rows.append([name, label, *_errors(model, colours)])
            squares.append(float(np.mean((model - colours) ** 2)))
        wins, total = wins + (squares[1] < squares[0]), total + 1
    measured: list[list[str]] = []
    bands = nearer = 0
    if cast.data is not None:
        skins = reflectance_to_rgb(measured_skins(cast.data), BANDS).astype(np.float32)
        angles = ita(skins)
        for low, high, label in ITA_BANDS:
            some = skins[(angles > low) & (angles <= high)]
            if not len(some):
                continue
            squares = []
            for tissue_name, tissue in TISSUES.items():
                model = explain(some, tissue)[1]
                squares.append(float(np.mean((model - some) ** 2)))
                measured.append(
                    [f"measured, {label} ({len(some)})", tissue_name, *_errors(model, some)]
                )
            bands, nearer = bands + 1, nearer + (squares[1] < squares[0])
    subject = next((s for s in cast.subjects if s.skin == "intermediate"), cast.subjects[0])
    return Section(
        name="gitlina",
        numbers={"faces": wins, "all_faces": total, "bands": nearer, "all_bands": bands},
        table=table(["skin", "tissue", "MSE", "ΔE00 mean", "p95"], rows + measured),
        pictures=((_gitlina_picture(subject), "The same face through both tissues: reconstruction, "
                   "absolute error × 10, and maps from their 2nd to their 98th percentile."),),
        credits=(f"{subject.name}: {subject.credit}",),
    )  # fmt: skip


def _gitlina_picture(subject: Subject) -> Any:
    source, rows = subject.calibrated, []
    inside = subject.mask > 0
    for tissue in TISSUES.values():
        maps, model = explain(source[inside], tissue)
        shown = np.ones_like(source)
        shown[inside] = model
        error = np.zeros_like(source)
        error[inside] = model - source[inside]
        row: list[Picture] = [displayed(shown), magnified(error, 10.0)]
        colours = COLOUR_MAPS | {"epidermal_blood": "Reds"}
        for known in tissue.parameters:
            values = np.full(source.shape[:2], np.nan)
            values[inside] = maps[known.name] ** (1 / known.root)
            low, high = np.percentile(values[subject.texels], [2, 98])
            row.append((values, colours[known.name], float(low), float(max(high, low + 1e-9))))
        rows.append(row)
    return grid(
        rows, list(TISSUES),
        ["model", "error × 10", "melanin", "blood", "eumelanin | thickness",
         "epidermal blood | eumelanin", "| oxygenation"], 1.3,
    )  # fmt: skip
