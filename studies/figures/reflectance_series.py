"""Reflectance of a series of melanin and of one of blood (the paper's figure 2)."""

import numpy as np

from cutis.albedo import albedo_space
from cutis.colour import lab, reflectance_to_rgb
from cutis.optics import ALIAGA2022, WAVELENGTHS
from cutis.report.appearance import displayed
from studies.figures.layout import curves, grid
from studies.figures.measured import BANDS, measured_skins
from studies.figures.section import Section, table
from studies.figures.subjects import Cast

MELANIN = (0.2, 0.7, 2.3, 5.4, 10.6, 18.2, 29.9, 43.1)
"""Per cent of melanosomes; blood is 2 %."""
BLOOD = (0.1, 0.2, 0.7, 2.0, 4.5, 9.6, 17.7, 30.0)
"""Per cent of blood; melanin is 0.8 %."""
HELD = (100.0, 0.6, 0.75)
"""Thickness in µm, eumelanin share, oxygenation; the paper does not print its own."""
PRINTED = (450.0, 550.0, 580.0, 650.0)
"""nm, the columns of the table."""


def draw(cast: Cast) -> Section:
    """Both series, with measured skins behind them where they are at hand."""
    space = albedo_space(ALIAGA2022)
    series = {
        "melanin": (MELANIN, [(m / 100, 0.02, *HELD) for m in MELANIN]),
        "blood": (BLOOD, [(0.008, b / 100, *HELD) for b in BLOOD]),
    }
    panels, rows, patches, ordered = [], [], [], {}
    at = [int(np.argmin(np.abs(WAVELENGTHS - nm))) for nm in PRINTED]
    for name, (values, skins) in series.items():
        spectra = space.reflectance(np.array(skins))
        rgb = reflectance_to_rgb(spectra, WAVELENGTHS)
        shades = displayed(rgb)
        ordered[name] = np.all(np.diff(spectra, axis=0) < 0, axis=0).mean()
        lines = [(s, c, f"{v:g} %") for s, c, v in zip(spectra, shades, values, strict=True)]
        panels.append((name, WAVELENGTHS, lines))
        patches.append([np.tile(c, (40, 40, 1)) for c in shades])
        for value, spectrum, coordinates in zip(values, spectra, lab(rgb), strict=True):
            rows.append(
                [name, f"{value:g} %", *(f"{spectrum[i]:.3f}" for i in at),
                 *(f"{v:.1f}" for v in coordinates)]
            )  # fmt: skip
    band, measured = None, ""
    if cast.data is not None:
        measured_albedo = measured_skins(cast.data)
        low, high = np.percentile(measured_albedo, [1, 99], axis=0)
        band = (BANDS, low, high, "98 % of measured skins")
        drawn = space.reflectance(np.array(series["melanin"][1]))[:, np.isin(WAVELENGTHS, BANDS)]
        share = np.mean((drawn >= low) & (drawn <= high))
        measured = (
            f"The grey band holds 98 % of {len(measured_albedo)} measured skins of all tones, the "
            f"surface's reflection taken off: {share:.0%} of the melanin series lies inside."
        )
    return Section(
        name="reflectance-series",
        numbers={
            **dict(zip(("thickness", "eumelanin", "oxygenation"), HELD, strict=True)),
            **ordered,
            "measured": measured,
        },
        table=table(["series", "value", *(f"{nm:g} nm" for nm in PRINTED), "L*", "a*", "b*"], rows),
        pictures=(
            (curves(panels, "albedo", band), "Spectra, drawn in their own colours."),
            (grid(patches, list(series), [""] * 8, 0.8), "Their colours under D65."),
        ),
    )
