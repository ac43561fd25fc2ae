"""Tables of docs/colour.md from measured skins: `python -m studies.illuminant_accuracy`.

Needs the larger data beside the project, or its folder as the only argument.
"""

import sys
from pathlib import Path

import numpy as np

from cutis.albedo import albedo_space, uniform
from cutis.albedo.lights import skin_conversion
from cutis.colour import (
    delta_e,
    illuminant,
    is_skin_colour,
    light_conversion,
    reflectance_to_rgb,
    spectrum_to_xyz,
)
from cutis.colour.observer import colour_matching
from cutis.colour.spectra import XYZ_TO_SRGB
from cutis.optics import ALIAGA2022, MEASURED2026, WAVELENGTHS
from studies.figures.measured import BANDS, measured_skins
from studies.figures.subjects import data_folder
from studies.pages import rewrite

LIGHTS = ("A", "D50", "D75", "FL1", "FL2", "FL7", "FL11", "FL12", "HP1", "LED-B3", "LED-V1",
          "LED-RGB1", "D65-prime", "D65-prime-RGB", "D65-prime-RGBW")  # fmt: skip
BALANCED = ("A", "D50", "FL2", "FL11", "LED-B3", "D65-prime")
"""Lights of the table of balances."""


def fitted(light: str, spectra: np.ndarray) -> np.ndarray:
    """The 3 × 3 conversion that suits the skins of the albedo space best, for comparison."""
    here = reflectance_to_rgb(spectra, WAVELENGTHS, light)
    there = reflectance_to_rgb(spectra, WAVELENGTHS)
    weight = 1 / there.mean(axis=1, keepdims=True)
    return np.linalg.lstsq(here * weight, there * weight, rcond=None)[0]


def balances(skins: np.ndarray, truth: np.ndarray) -> str:
    """What the conversion makes of captures that were balanced otherwise, or not at all."""
    from colour.adaptation import matrix_chromatic_adaptation_VonKries

    rows = [
        "| light | channel gains, converted | left | Bradford, converted | left | none, converted "
        "| left |",
        "|---|---|---|---|---|---|---|",
    ]
    whites = {name: illuminant(name) @ colour_matching() for name in ("D65", *BALANCED)}
    for light in BALANCED:
        white, target = (whites[name] / whites[name][1] for name in (light, "D65"))
        xyz = skins @ spectrum_to_xyz(BANDS, light)
        unbalanced = xyz @ XYZ_TO_SRGB.T
        adaptation = matrix_chromatic_adaptation_VonKries(white, target, "Bradford")
        bradford = xyz @ adaptation.T @ XYZ_TO_SRGB.T
        errors = [
            delta_e(seen @ way, truth)
            for seen in (reflectance_to_rgb(skins, BANDS, light), bradford, unbalanced)
            for way in (light_conversion(light).T, np.eye(3))
        ]
        cells = [f"{e.mean():.2f} / {np.percentile(e, 95):.2f}" for e in errors]
        rows.append(f"| {light} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def main() -> None:
    data = data_folder(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder")
    skins = measured_skins(data)
    truth = reflectance_to_rgb(skins, BANDS)
    space = albedo_space(ALIAGA2022)
    synthetic = uniform(20_000, 5)
    synthetic = space.reflectance(synthetic[is_skin_colour(space.rgb(synthetic))])
    rows = [
        f"ΔE00 to the true colour under D65 of {len(skins)} measured skins, mean / p95:",
        "",
        "| light | as captured | converted | best 3 × 3 for `aliaga2022` | `measured2026` |",
        "|---|---|---|---|---|",
    ]
    for light in LIGHTS:
        seen = reflectance_to_rgb(skins, BANDS, light)
        cells = [
            delta_e(colours, truth)
            for colours in (
                seen,
                seen @ light_conversion(light).T,
                seen @ fitted(light, synthetic),
                seen @ skin_conversion(light, MEASURED2026).T,
            )
        ]
        rows.append(
            f"| {light} | "
            + " | ".join(f"{e.mean():.2f} / {np.percentile(e, 95):.2f}" for e in cells)
            + " |"
        )
    variants = [light for light in LIGHTS if light.startswith("D65-prime")]
    choice = [
        "ΔE00, mean / p95, when a capture under the light of the row is converted as if under that "
        "of the column:",
        "",
        "| captured under | " + " | ".join(variants) + " |",
        "|---" * (len(variants) + 1) + "|",
    ]
    for row in variants:
        seen = reflectance_to_rgb(skins, BANDS, row)
        errors = [delta_e(seen @ light_conversion(column).T, truth) for column in variants]
        choice.append(
            f"| {row} | "
            + " | ".join(f"{e.mean():.2f} / {np.percentile(e, 95):.2f}" for e in errors)
            + " |"
        )
    rewrite("colour.md", lights="\n".join(rows), prime="\n".join(choice),
            balances=balances(skins, truth))  # fmt: skip


if __name__ == "__main__":
    main()
