"""Captures under another light (supplement, figure 1), and metamers (discussed in the paper)."""

import numpy as np

from cutis.albedo import albedo_space
from cutis.colour import delta_e, light_conversion
from cutis.inverse import colours_under, metamers, spread
from cutis.optics import ALIAGA2022, NAMES, PARAMETERS, WAVELENGTHS
from cutis.report.appearance import displayed
from studies.figures.layout import curves, grid, magnified
from studies.figures.section import Section, table
from studies.figures.subjects import Cast

PRIMES = ("D65-prime", "D65-prime-RGB", "D65-prime-RGBW")
TONES = {
    "light": (0.02, 0.02, 80.0, 0.7, 0.7),
    "intermediate": (0.06, 0.02, 90.0, 0.7, 0.7),
    "dark": (0.25, 0.02, 90.0, 0.8, 0.7),
}
"""Skins whose families are drawn."""
LIGHTS = ("D65", "A", "FL11", "LED-B3")


def draw_illuminants(cast: Cast) -> Section:
    """Faces as if captured under D65-prime, brought to D65."""
    pictures, rows, moves = [], [], []
    for subject in cast.subjects[:3]:
        source = np.clip(subject.rgb, 0, None)
        converted = source @ light_conversion(PRIMES[0]).T
        pictures.append(
            [displayed(source), displayed(converted), magnified(converted - source)]
            + [displayed(source @ light_conversion(other).T) for other in PRIMES[1:]]
        )
        inside = subject.texels
        for light in PRIMES:
            moved = source[inside] @ light_conversion(light).T
            moves.append(float(delta_e(moved, source[inside]).mean()))
            rows.append([subject.skin, light, f"{moves[-1]:.2f}"])
    return Section(
        name="illuminants",
        numbers={"least": min(moves), "most": max(moves)},
        table=table(["skin", "light", "mean ΔE00 of the conversion"], rows),
        pictures=(
            (
                grid(pictures, [s.skin for s in cast.subjects[:3]],
                     ["as captured", "D65", "difference × 4", "from -RGB", "from -RGBW"]),
                "The capture taken as one under D65-prime, brought to D65, the difference, and the "
                "same from the two other mixtures.",
            ),
        ),
        credits=cast.credits[:3],
    )  # fmt: skip


def draw_metamers(cast: Cast) -> Section:
    """Families of skins within one ΔE00, what they span, how they part under other lights."""
    space, panels, ranges, parted, swatches = albedo_space(ALIAGA2022), [], [], [], []
    means: dict[tuple[str, str], float] = {}
    spans: dict[str, np.ndarray] = {}
    for tone, skin in TONES.items():
        family = metamers(space.rgb(np.array(skin)), 1.0, 1000, space=space)
        low, high = np.percentile(family.skins, [5, 95], axis=0)
        spans[tone] = high / low
        ranges.append(
            [tone, f"{family.share:.1e}"]
            + [
                f"{a:.3g}–{b:.3g} {p.unit.replace('1', '')}".strip()
                for p, a, b in zip(PARAMETERS, low, high, strict=True)
            ]
        )  # fmt: skip
        colours = colours_under(family.skins, LIGHTS, space)
        for light in LIGHTS:
            errors = spread(colours[light])
            means[tone, light] = float(errors.mean())
            parted.append(
                [tone, light, f"{errors.mean():.2f}", f"{np.percentile(errors, 95):.2f}",
                 f"{errors.max():.2f}"]
            )  # fmt: skip
        some = family.skins[:60]
        spectra = space.reflectance(some)
        panels.append((tone, WAVELENGTHS, [(s, displayed(family.colour), None) for s in spectra]))
        for light in ("D65", "A"):
            chips = displayed(colours[light][:40]).reshape(4, 10, 3)
            swatches.append([chips.repeat(12, 0).repeat(12, 1)])
    text = (
        table(["skin", "share of the space", *NAMES], ranges)
        + "\n\n"
        + table(["skin", "light", "ΔE00 from the family's mean", "p95", "max"], parted)
    )
    return Section(
        name="metamers",
        numbers={
            "melanin": spans["light"][0],
            "blood": spans["light"][1],
            "dark_blood": spans["dark"][1],
            **{tone: means[tone, "A"] / means[tone, "D65"] for tone in ("light", "dark")},
        },
        table=text,
        pictures=(
            (curves(panels, "albedo"), "Sixty members of each family: one colour under D65."),
            (
                grid(swatches, [f"{tone}, {light}" for tone in TONES for light in ("D65", "A")],
                     [""], 3.0),
                "Forty members of each family under D65 and under A.",
            ),
        ),
    )  # fmt: skip
