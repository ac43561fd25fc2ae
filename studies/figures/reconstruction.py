"""Reconstruction by networks and by the tensor (the paper's figure 8)."""

import numpy as np

from cutis.colour import delta_e
from cutis.inverse.shipped import EXACT
from cutis.report.appearance import displayed
from studies.figures.layout import grid, magnified
from studies.figures.section import Section, table
from studies.figures.subjects import Cast

METHODS = {"aliaga2022": "network", "lookup": "tensor, 256k", EXACT: "exact"}


def draw(cast: Cast) -> Section:
    """Every subject as captured, as each method gives it, and four times the error."""
    rows, pictures = [], []
    means: dict[str, list[float]] = {name: [] for name in METHODS}
    for subject in cast.subjects:
        source = subject.calibrated
        row = [displayed(source)]
        for name, label in METHODS.items():
            skin = subject.maps_by(name)
            model = skin.calibration.apply(skin.model_albedo)
            error = model - source
            row += [displayed(model), magnified(np.where(subject.mask[..., None] > 0, error, 0))]
            inside = subject.texels
            distance = delta_e(model[inside], source[inside])
            means[name].append(float(np.mean(error[inside] ** 2)))
            rows.append(
                [subject.skin, label, f"{means[name][-1]:.1e}", f"{distance.mean():.2f}",
                 f"{np.percentile(distance, 95):.2f}"]
            )  # fmt: skip
        pictures.append(row)
    each = list(zip(*means.values(), strict=True))
    return Section(
        name="reconstruction",
        numbers={
            "worst": max(max(row) for row in each),
            "nearer": sum(tensor < network for network, tensor, _ in each),
            "best": sum(exact < min(others) for *others, exact in each),
            "count": len(each),
        },
        table=table(["skin", "method", "MSE", "ΔE00 mean", "p95"], rows),
        pictures=(
            (
                grid(
                    pictures,
                    [s.skin for s in cast.subjects],
                    ["capture", *(t for label in METHODS.values() for t in (label, "error × 4"))],
                    1.15,
                ),
                "Captures after white balance, what each method alone gives, and its absolute "
                "error in linear RGB, four times.",
            ),
        ),
        credits=cast.credits,
    )
