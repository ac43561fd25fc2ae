"""What the report page says of its numbers: a verdict, the calibration, what to trust."""

import math
from collections.abc import Iterator
from typing import Any

from cutis.report import trust_words

MANY = 0.05
"""Share of texels out of gamut, or at the end of a range, that is worth a warning."""
FEW_SKIN = 0.2
"""Share of the mask with the colour of skin below which the colour errors say little."""
CATEGORIES = (
    (55.0, "very light"), (41.0, "light"), (28.0, "intermediate"), (10.0, "tan"), (-30.0, "brown"),
)  # fmt: skip
"""ITA° above which a skin is called so [chardon1991ita]; below all it is dark."""
FIXED = {
    "melanin": ("good", "RGB fixes it well"),
    "blood": ("good", "RGB fixes it well"),
    "thickness": ("care", "RGB fixes it less"),
    "eumelanin": ("doubt", "RGB hardly fixes it"),
    "oxygenation": ("doubt", "RGB hardly fixes it"),
}
"""How far three colour values determine each map where the model has no σ: a level and words."""
ADVICE = {
    "good": "Compare it across a face and between faces captured and calibrated alike; exposure "
    "and white balance move its absolute values on top.",
    "care": "Take it as a tendency: other values about as far away give the same colour.",
    "doubt": "The colour says little more of it than is known of skins in general, and the map "
    "holds a probable value. It is a control for edits, not a finding.",
}
"""What to do with a map of each level."""
LEVELS = {"good": "Sound", "care": "With care", "doubt": "Doubtful"}
"""Levels of trust in words, since colour alone says nothing to some."""


def number(value: float | None) -> str:
    """Three digits, as read rather than as computed; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value and abs(value) < 1e-3:
        digits, power = f"{value:.1e}".split("e")
        superscript = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return f"{digits} × 10{superscript}".replace("-", "−")
    return (f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}").replace("-", "−")


def percent(share: float | None) -> str:
    """A share as percent; what is there but rounds to nothing is not called nothing."""
    if share is None or not math.isfinite(share):
        return "–"
    if 0 < share < 5e-5:
        return "< 0.01\u00a0%"
    return f"{100 * share:.{2 if share < 0.01 else 1}f}\u00a0%"


def degrees(ita: float | None) -> str:
    """An ITA°, to a tenth."""
    if ita is None or not math.isfinite(ita):
        return "–"
    return f"{ita:.1f}°".replace("-", "−")


def category(ita: float | None) -> str:
    """The skin colour category of an ITA°."""
    if ita is None or not math.isfinite(ita):
        return "not known"
    return next((word for limit, word in CATEGORIES if ita > limit), "dark")


def verdict(report: dict[str, Any]) -> str:
    """One sentence on how well the model explains the capture."""
    colour = report.get("colour")
    if colour is None:
        return (
            "No texel inside the mask has the colour of skin, so there is no colour error to "
            "report. Check the mask and the colour space before using the maps."
        )
    out = percent(colour["out_of_gamut"])
    if colour["out_of_gamut"] <= MANY:
        return (
            "The model explains this capture: on skin it comes within ΔE00 "
            f"{number(colour['delta_e_mean'])} on average, and {out} of the texels have a colour "
            "that no skin of the model has."
        )
    if colour["out_of_gamut"] <= 0.25:
        return (
            f"The model explains most of this capture, but {out} of the skin texels have a colour "
            "that no skin of the model has; see below what that means for the maps."
        )
    return (
        f"The model does not explain a large part of this capture: {out} of the skin texels have "
        "a colour that no skin of the model has. Read the calibration below before using the maps."
    )


def calibration(found: dict[str, Any]) -> Iterator[str]:
    """Paragraphs on the gains of a report: where they come from, what they say of the capture."""
    origin = found.get("origin", "none")
    if found.get("illuminant", "D65") != "D65":
        yield f"The capture was converted from {found['illuminant']}, its light, to D65 first."
    if origin == "none":
        yield (
            "No calibration was asked for: brightness and white balance of the capture were taken "
            "as they are. If they are off, the maps are off with them."
        )
        return
    yield (
        "These gains were searched for: with them the model explains most of the skin."
        if origin == "auto"
        else "These gains were given, not searched for."
    ) + " They are undone on output, so colours come back as they came."
    gains = dict(zip(("red", "green", "blue"), found["gains"], strict=True))
    exposure = math.prod(gains.values()) ** (1 / 3)
    if abs(math.log(exposure)) < 0.02:
        yield "They keep the brightness of the capture."
    else:
        side = "brighter" if exposure < 1 else "darker"
        amount = 1 / exposure if exposure < 1 else exposure
        yield (
            f"They take the capture to be {number(amount)} times {side} than the albedo it shows."
        )
    strong = min(gains, key=gains.__getitem__)
    weak = max(gains, key=gains.__getitem__)
    if gains[weak] / gains[strong] < 1.03:
        yield "They leave its white balance as it is."
    else:
        yield (
            f"They correct a cast: {strong} too strong, {weak} too weak, by a factor of "
            f"{number(gains[weak] / gains[strong])} between the two."
        )


def findings(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """(level, sentences) on what the maps of this report can be trusted for."""
    yield from _of_colour(report)
    for name, share in (report.get("clamped") or {}).items():
        if share > MANY:
            yield (
                "doubt",
                f"{percent(share)} of the {name} map lie at an end of its range: it saturates "
                "there, and the skin may hold less or more than it shows.",
            )
    texels = report.get("masked_texels", 0)
    for key, what in (("below_0", "below 0"), ("above_1", "above 1")):
        if report.get(key):
            share = f" ({percent(report[key] / texels)})" if texels else ""
            yield (
                "care",
                f"{report[key]:,} texels{share} have a colour {what}, which is no albedo; the maps "
                "hold the nearest skin there.",
            )
    maps = report.get("maps") or {}
    told = [(name, trust_words.known(maps, name)) for name in maps]
    if any(found for _, found in told):
        yield from _of_confidence(report)
        for name, found in told:
            if found is not None:
                level, known = found
                spread = trust_words.spread(maps, name)
                yield level, f"{name.capitalize()}: {known}, {spread} (median σ). {ADVICE[level]}"
        return
    yield (
        "good",
        "Melanin and blood: three colour values fix these two well. Compare them across a face "
        "and between faces captured and calibrated alike; their absolute values move with "
        "exposure and white balance.",
    )
    yield (
        "care",
        "Thickness: fixed less well, since a thicker epidermis with less melanin looks much the "
        "same. Take it as a tendency.",
    )
    yield (
        "doubt",
        "Eumelanin and oxygenation: hardly fixed. Many values give the same colour, and the maps "
        "hold a probable one. They are controls for edits, not findings.",
    )


def fixed(report: dict[str, Any], name: str) -> tuple[str, str]:
    """A level and a few words on how far a map is known: what σ says, else FIXED."""
    return trust_words.known(report.get("maps") or {}, name) or FIXED[name]


def _of_confidence(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    share = report.get("low_confidence")
    if share is not None and share > trust_words.UNSURE:
        yield (
            "care",
            f"{percent(share)} of the mask have a colour that is hardly one of skin; what is said "
            "of the maps below is said of the rest.",
        )


def _of_colour(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    colour = report.get("colour")
    if colour is None:
        yield "doubt", "Nothing inside the mask looks like skin, so none of the maps can be judged."
        return
    share = report["skin_texels"] / report["masked_texels"] if report.get("masked_texels") else 1.0
    if share < FEW_SKIN:
        yield (
            "care",
            f"Only {percent(share)} of the mask are in the colour errors; darker and greyer texels "
            "(L* ≤ 35 or C*ab ≤ 12) are not.",
        )
    out = colour["out_of_gamut"]
    if out <= MANY:
        yield (
            "good",
            f"Colour: the model alone differs from the capture by ΔE00 "
            f"{number(colour['delta_e_p95'])} or less on 95 % of the skin; below 1 hardly anyone "
            "sees a difference. What it does not explain is kept through edits.",
        )
    elif report.get("calibration", {}).get("origin") == "auto":
        yield (
            "doubt",
            f"{percent(out)} of the skin texels are out of gamut although gains were searched for: "
            "look in the ΔE00 picture for hair, lips, make-up or shading inside the mask, and "
            "tighten it. The maps hold the nearest skin there.",
        )
    else:
        yield (
            "doubt",
            f"{percent(out)} of the skin texels are out of gamut: exposure or white balance are "
            "probably off, which shifts all five maps. Estimate again with --white auto, or with "
            "a tighter --mask.",
        )
