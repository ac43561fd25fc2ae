"""Edits through look-up tensors and through networks (the paper's figure 4)."""

import numpy as np
from numpy.typing import NDArray

from cutis.inverse.shipped import EXACT
from cutis.looks import presets
from cutis.report.appearance import displayed
from studies.figures.layout import grid
from studies.figures.section import Section, table
from studies.figures.subjects import Cast, Subject

METHODS = {
    "lookup-55k": "tensor, 55k",
    "lookup": "tensor, 256k",
    "aliaga2022": "network",
    EXACT: "exact",
}
SHOWN = "intermediate"
"""Skin of the subject that is drawn."""
DETAIL = 110
"""Texels of the side of the detail that is drawn."""


def roughness(colours: NDArray[np.floating], where: NDArray[np.bool_]) -> float:
    """Mean relative second difference along rows, texels `where`: steps and noise, not shading."""
    inside = where[:, 1:-1] & where[:, 2:] & where[:, :-2]
    second = colours[:, 2:] - 2 * colours[:, 1:-1] + colours[:, :-2]
    return float(np.mean(np.abs(second[inside]).mean(axis=-1) / colours[:, 1:-1][inside].mean(-1)))


def draw(cast: Cast) -> Section:
    """Three times the melanin, by each method: the picture, a detail and its roughness."""
    subject = next((s for s in cast.subjects if s.skin == SHOWN), cast.subjects[0])
    rows, faces, details, edited = [], [], [], {}
    detail = _detail(subject)
    for name, label in METHODS.items():
        skin = subject.maps_by(name)
        plain = skin.calibration.apply(skin.model_albedo)
        triple = skin.calibration.apply(skin.apply(presets.melanin_triple).model_albedo)
        edited[name] = roughness(triple, subject.texels)
        shades = len(np.unique(np.round(triple[subject.texels], 6), axis=0))
        rows.append(
            [label, f"{roughness(plain, subject.texels):.4f}", f"{edited[name]:.4f}", f"{shades}"]
        )
        faces.append(displayed(triple))
        details.append(displayed(triple[detail]))
    source = subject.calibrated
    first = [
        "capture", f"{roughness(source, subject.texels):.4f}", "",
        f"{len(np.unique(np.round(source[subject.texels], 6), axis=0))}",
    ]  # fmt: skip
    return Section(
        name="quantisation",
        numbers={
            "lookup55k": edited["lookup-55k"],
            "lookup": edited["lookup"],
            "network": edited["aliaga2022"],
            "exact": edited[EXACT],
        },
        table=table(["method", "roughness, as estimated", "melanin × 3", "shades"], [first, *rows]),
        pictures=(
            (
                grid(
                    [[displayed(source), *faces], [displayed(source[detail]), *details]],
                    ["melanin × 3", "detail"],
                    ["capture", *METHODS.values()],
                ),
                "What the model alone gives for three times the melanin, and a detail of it.",
            ),
        ),
        credits=(f"{subject.name}: {subject.credit}",),
    )


def _detail(subject: Subject) -> tuple[slice, slice]:
    """A square in the middle of the skin."""
    y, x = (int(np.median(axis)) for axis in np.nonzero(subject.texels))
    return slice(max(y - DETAIL // 2, 0), y + DETAIL // 2), slice(
        max(x - DETAIL // 2, 0), x + DETAIL // 2
    )
