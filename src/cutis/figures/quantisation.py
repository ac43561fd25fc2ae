"""Edits through look-up tensors and through networks (the paper's figure 4)."""

import numpy as np
from numpy.typing import NDArray

from cutis.figures.layout import displayed, grid
from cutis.figures.section import Section, table
from cutis.figures.subjects import Cast, Subject
from cutis.maps import presets

METHODS = {
    "lookup-55k": "tensor, 55k",
    "lookup": "tensor, 256k",
    "aliaga2022": "network",
    "default": "default",
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
        title="Quantisation of edits",
        paper="Through a tensor an albedo is reproduced almost exactly, but its maps are noisy, "
        "and "
        "tripled melanin shows steps and shifts of colour even with 256 000 skins; the network "
        "gives clean edits.",
        found="**Agreement.** Roughness is the mean relative second difference of neighbouring "
        f"texels. Tripled melanin through the tensors is {edited['lookup-55k']:.3f} (55k) and "
        f"{edited['lookup']:.3f} (256k) rough, through the network {edited['aliaga2022']:.3f}, "
        f"through the default {edited['default']:.3f}; before the edit all are alike. More nodes "
        "help little: neighbouring colours still fall on far-apart skins.",
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
