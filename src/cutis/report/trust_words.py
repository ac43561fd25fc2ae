"""What σ says of the maps of one face, in words: for the summary, `cutis info` and the page.

A map is *informed* by 1 − σ / σ of the prior (`maps.trust`): 1 when the colour fixes it, 0 when the
colour says no more than was known of skins before.
"""

import math
from collections.abc import Iterator, Mapping

from cutis.report.numbers import MapNumbers

WELL, ROUGHLY = 0.7, 0.35
"""Informed by at least this much a map is well known, or roughly; below it is hardly known."""
DARK = 0.1
"""Median melanin from which blood that is hardly known is called hidden by melanin: little light
comes back from below such an epidermis."""
BELOW = ("blood", "oxygenation")
"""Maps of what lies below the epidermis."""
FRACTIONS = ("melanin", "blood")
"""Maps whose σ is said as a share of their median: they span powers of ten."""
UNSURE = 0.05
"""Share of texels with a low confidence that is worth a word."""

Maps = Mapping[str, MapNumbers]
"""What a report says of each map, by name."""


def known(maps: Maps, name: str, doubted: bool = False) -> tuple[str, str] | None:
    """A level of `words.LEVELS` and words on how far a map is known; None without σ.

    σ takes the colour for one of skin: where the input is `doubted` no map is known from it.
    """
    informed = maps[name].informed if name in maps else None
    if informed is None or not math.isfinite(informed):
        return None
    if doubted:
        return "doubt", "not to be trusted, as the input is doubtful"
    if informed >= WELL:
        return "good", "well known"
    if informed >= ROUGHLY:
        return "care", "roughly known"
    if name in BELOW and _middle(maps.get("melanin")) >= DARK:
        return "doubt", "hidden by melanin on this face"
    return "doubt", "hardly known"


def spread(maps: Maps, name: str) -> str:
    """Median σ of a map as ± so much, relative for FRACTIONS: "±8 %", "±22 µm"."""
    row = maps[name]
    sigma, unit, middle = row.sigma or 0.0, row.unit, _middle(row)
    if name in FRACTIONS and middle:
        share = 100 * sigma / middle
        return f"±{share:.0f} %" if share < 100 else "± more than its value"
    return f"±{sigma:.2g}" + ("" if unit == "1" else f" {unit}")


def _middle(row: MapNumbers | None) -> float:
    """Median over the texels that σ is of; hair in a mask has no part in it."""
    if row is None:
        return 0.0
    return row.median if row.sure_median is None else row.sure_median


def lines(maps: Maps, low_confidence: float | None, doubted: bool = False) -> Iterator[str]:
    """A line for each map with σ, and one where many texels are not sure to be skin."""
    for name in maps:
        found = known(maps, name, doubted)
        if found is not None:
            spread_of = "" if doubted else f", {spread(maps, name)}"
            yield f"{name}: {found[1]}{spread_of}"
    if low_confidence is not None and low_confidence > UNSURE:
        yield (
            f"{100 * low_confidence:.0f} % of the mask have a colour that is hardly one of skin; "
            "they are not in these words"
        )
