"""Rewrites the table of docs/decisions/0009-illuminants.md: other ways from a light to D65.

`python -m studies.light_alternatives` needs the larger data beside the project, or its folder as
the only argument.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.optimize import linprog, nnls

from cutis.colour import (
    delta_e,
    light_conversion,
    mallett_basis,
    reflectance_to_rgb,
    spectrum_to_rgb,
)
from cutis.colour.observer import illuminant_names, wavelengths
from studies.figures.measured import BANDS, measured_skins
from studies.figures.subjects import data_folder
from studies.pages import rewrite

LIGHTS = ("A", "D50", "FL1", "FL2", "FL11", "LED-B3", "D65-prime", "D65-prime-RGB")
COUNT = len(wavelengths())
STIFF = 1e3
"""Weight of the equalities, which non-negative least squares takes as rows."""


def equalities(light: str) -> tuple[np.ndarray, np.ndarray]:
    """Rows and right side: three reflectances are red, green, blue under `light`, and sum to 1."""
    colours = np.kron(np.eye(3), spectrum_to_rgb(wavelengths(), light).T)
    sums = np.tile(np.eye(COUNT), 3)
    return np.vstack([colours, sums]), np.concatenate([np.eye(3).ravel(), np.ones(COUNT)])


def exists(light: str) -> bool:
    """Whether any three reflectances in [0, 1] do so."""
    rows, right = equalities(light)
    return linprog(np.zeros(3 * COUNT), A_eq=rows, b_eq=right, bounds=(0, 1)).status == 0


def least_slope(light: str, bounded: bool = True) -> np.ndarray:
    """(81, 3) those whose slopes squared sum to the least."""
    rows, right = equalities(light)
    slopes = np.kron(np.eye(3), np.diff(np.eye(COUNT), axis=0))
    system = np.vstack([slopes, STIFF * rows])
    aim = np.concatenate([np.zeros(len(slopes)), STIFF * right])
    found = nnls(system, aim, maxiter=20_000) if bounded else np.linalg.lstsq(system, aim)
    return found[0].reshape(3, COUNT).T


def conversion(basis: np.ndarray, light: str) -> np.ndarray:
    """(3, 3) from RGB under `light` to RGB under D65 by mixes of `basis`, as rgb @ matrix."""
    here, there = (basis.T @ spectrum_to_rgb(wavelengths(), name) for name in (light, "D65"))
    return np.linalg.inv(here) @ there


def main() -> None:
    data = data_folder(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder")
    skins = measured_skins(data)
    truth = reflectance_to_rgb(skins, BANDS)
    of_d65 = least_slope("D65")
    rows = [
        "| light | as captured | published basis | least slope, under D65 | least slope, under the "
        "light | the same, may be negative |",
        "|---|---|---|---|---|---|",
    ]
    for light in LIGHTS:
        seen = reflectance_to_rgb(skins, BANDS, light)
        ways = [np.eye(3), light_conversion(light).T, conversion(of_d65, light)]
        ways.append(conversion(least_slope(light), light) if exists(light) else None)
        ways.append(conversion(least_slope(light, bounded=False), light))
        cells = [
            "none exists" if way is None else f"{delta_e(seen @ way, truth).mean():.2f}"
            for way in ways
        ]
        rows.append(f"| {light} | " + " | ".join(cells) + " |")
    names = illuminant_names()
    lacking = [name for name in names if not exists(name)]
    rows += ["", f"None exists for {len(lacking)} of {len(names)} lights: {', '.join(lacking)}."]
    published, least = (np.sum(np.diff(b, axis=0) ** 2) for b in (mallett_basis(), of_d65))
    rows.append(f"Squared steps of 5 nm sum to {published:.2f} in the published basis, {least:.2f} "
                "at the least.")  # fmt: skip
    rewrite("decisions/0009-illuminants.md", alternatives="\n".join(rows))


if __name__ == "__main__":
    main()
