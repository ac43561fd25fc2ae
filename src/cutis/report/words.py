"""Numbers as people read them, and the words for how far they can be trusted."""

import math

LEVELS = {"good": "Sound", "care": "With care", "doubt": "Doubtful"}
"""Levels of trust in words, since colour alone says nothing to some."""
CATEGORIES = (
    (55.0, "very light"), (41.0, "light"), (28.0, "intermediate"), (10.0, "tan"), (-30.0, "brown"),
)  # fmt: skip
"""ITA° above which a skin is called so [chardon1991ita]; below all it is dark."""


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


def with_unit(text: str, unit: str) -> str:
    """A number and its unit; fractions have none."""
    return text if unit in ("", "1") else f"{text} {unit}"
