"""What the numbers of a report mean: a verdict, the calibration, what to trust, what to do next."""

import math
from collections.abc import Iterator
from shlex import quote

from cutis.report import trust_words
from cutis.report.numbers import CalibrationNumbers, Report
from cutis.report.words import number, percent

MANY = 0.05
"""Share of texels out of gamut, or at the end of a range, that is worth a warning."""
MOST = 0.25
"""Share out of gamut above which the model does not explain a capture."""
FEW_SKIN = 0.2
"""Share of the mask with the colour of skin below which the colour errors say little."""
FIXED = {
    "melanin": ("good", "RGB fixes it well"),
    "blood": ("good", "RGB fixes it well"),
    "thickness": ("care", "RGB fixes it less"),
    "eumelanin": ("doubt", "RGB hardly fixes it"),
    "oxygenation": ("doubt", "RGB hardly fixes it"),
}
"""How far three colour values determine each map where the model has no σ: a level and words."""
ADVICE = {
    "good": "Compare it across a face, and between faces captured and calibrated alike; exposure "
    "and white balance move its absolute values on top.",
    "care": "Take it as a tendency: other values about as far away give the same colour.",
    "doubt": "The colour says little more of it than is known of skins in general, and the map "
    "holds a probable value. It is a control for edits, not a finding.",
}
"""What to do with a map of each level."""


def verdict(report: Report) -> str:
    """One sentence on how well the model explains the capture."""
    colour = report.colour
    if report.doubts:
        return (
            "This may be no albedo of skin, or not as its file says; see the doubts below before "
            "using the maps, however well the model explains its colours."
        )
    if colour is None:
        return (
            "No texel inside the mask has the colour of skin, so there is no colour error to "
            "report. Check the mask and the colour space before using the maps."
        )
    out = percent(colour.out_of_gamut)
    if colour.out_of_gamut <= MANY:
        return (
            "The model explains this capture: on skin it comes within ΔE00 "
            f"{number(colour.delta_e_mean)} on average, and {out} of the texels have a colour "
            "that no skin of the model has."
        )
    if colour.out_of_gamut <= MOST:
        return (
            f"The model explains most of this capture, but {out} of the skin texels have a colour "
            "that no skin of the model has; see below what that means for the maps."
        )
    return (
        f"The model does not explain a large part of this capture: {out} of the skin texels have "
        "a colour that no skin of the model has. Read the calibration below before using the maps."
    )


def calibration(found: CalibrationNumbers) -> Iterator[str]:
    """Paragraphs on the gains of a report: where they come from, what they say of the capture."""
    if found.illuminant != "D65":
        yield f"The capture was converted from {found.illuminant}, its light, to D65 first."
    if found.origin == "none":
        yield (
            "No calibration was asked for: brightness and white balance of the capture were taken "
            "as they are. If they are off, the maps are off with them."
        )
        return
    yield (
        "These gains were searched for: with them the model explains most of the skin."
        if found.origin == "auto"
        else "These gains were given, not searched for."
    ) + " They are undone on output, so colours come back as they came."
    gains = dict(zip(("red", "green", "blue"), found.gains, strict=True))
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


def findings(report: Report) -> Iterator[tuple[str, str]]:
    """(level, sentences) on what the maps of this report can be trusted for."""
    for doubt in report.doubts:
        said = doubt.sentence[:1].upper() + doubt.sentence[1:]
        yield "doubt", f"{said} {doubt.hint}".rstrip()
    yield from _of_colour(report)
    for name, share in report.clamped.items():
        if share > MANY:
            yield (
                "doubt",
                f"{percent(share)} of the {name} map lie at an end of its range: it saturates "
                "there, and the skin may hold less or more than it shows.",
            )
    for count, what in ((report.below_0, "below 0"), (report.above_1, "above 1")):
        if count:
            part = f" ({percent(count / report.masked_texels)})" if report.masked_texels else ""
            yield (
                "care",
                f"{count:,} texels{part} have a colour {what}, which is no albedo; the maps hold "
                "the nearest skin there.",
            )
    told = [(name, trust_words.known(report.maps, name)) for name in report.maps]
    if any(found for _, found in told):
        unsure = report.low_confidence
        if unsure is not None and unsure > trust_words.UNSURE:
            yield (
                "care",
                f"{percent(unsure)} of the mask have a colour that is hardly one of skin; what is "
                "said of the maps below is said of the rest.",
            )
        for name, found in () if report.doubts else told:
            if found is not None:
                level, known = found
                spread = trust_words.spread(report.maps, name)
                yield level, f"{name.capitalize()}: {known}, {spread} (median σ). {ADVICE[level]}"
    if report.doubts:
        yield "doubt", "All five maps: the input is doubtful, and so are they."
    if report.doubts or any(found for _, found in told):
        return
    yield (
        "good",
        "Melanin and blood: three colour values fix these two well. Compare them across a face, "
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


def fixed(report: Report, name: str) -> tuple[str, str]:
    """A level and a few words on how far a map is known: what σ says, else FIXED."""
    doubted = bool(report.doubts)
    found = trust_words.known(report.maps, name, doubted)
    return found or (("doubt", "the input is doubtful") if doubted else FIXED[name])


def next_steps(
    report: Report, face: str, maps: str, mask: str | None = None, output: str | None = None
) -> Iterator[tuple[str, str]]:
    """(what to do, the command for it or nothing), most pressing first.

    `face`, `maps` and `mask` are the files of the capture, `output` its folder, where known. What
    is wrong with the input comes before what can be done with the result.
    """
    colour, searched = report.colour, report.calibration.origin == "auto"
    maps = quote(maps)
    to = "" if output is None else f" -o {quote(output)}"
    same = quote(face) + ("" if mask is None else f" --mask {quote(mask)}") + to
    other = f"{quote(face)} --mask MASK{to}"
    if colour is None:
        yield "Look whether the mask covers skin and the colour space is the right one.", ""
        yield (
            "Then estimate again, with both of them said.",
            f"cutis estimate {other} --colorspace sRGB --again",
        )
        return
    if colour.out_of_gamut > MANY and not searched:
        yield (
            "Let the gains be searched for: exposure or white balance are probably off.",
            f"cutis estimate {same} --white auto --again",
        )
    elif colour.out_of_gamut > MANY:
        yield (
            "Take hair, lips, make-up and shading out of the mask: they are bright in the picture "
            "of ΔE00.",
            f"cutis estimate {other} --white auto --again",
        )
    if report.above_1 + report.below_0 > MANY * report.masked_texels:
        yield "Look for highlights and clipped texels: an albedo has none.", ""
    if colour.out_of_gamut <= MANY and not searched and report.calibration.origin == "none":
        yield (
            "If brightness or white balance of the capture are not known to be right, let gains be "
            "searched for.",
            f"cutis estimate {same} --white auto --again",
        )
    yield (
        "Change the skin; what no edit touches stays as it is, bit for bit.",
        f"cutis edit {maps} --melanin x1.5 --blood x0.8 -o edited.png",
    )
    yield (
        "See it on its head, under a light.",
        f"cutis render {maps} --mesh HEAD.obj -o head.png",
    )


def _of_colour(report: Report) -> Iterator[tuple[str, str]]:
    colour = report.colour
    if colour is None:
        yield "doubt", "Nothing inside the mask looks like skin, so none of the maps can be judged."
        return
    if report.skin_share < FEW_SKIN:
        yield (
            "care",
            f"Only {percent(report.skin_share)} of the mask are in the colour errors; darker and "
            "greyer texels (L* ≤ 35 or C*ab ≤ 12) are not.",
        )
    out = colour.out_of_gamut
    if out <= MANY:
        yield (
            "good",
            f"Colour: the model alone differs from the capture by ΔE00 "
            f"{number(colour.delta_e_p95)} or less on 95 % of the skin; below 1 hardly anyone "
            "sees a difference. What it does not explain is kept through edits.",
        )
    elif report.calibration.origin == "auto":
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
