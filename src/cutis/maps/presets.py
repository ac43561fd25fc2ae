"""Named edits: those that the paper shows, with its amounts [aliaga2022].

Each preset is a tuple of `Edit`; `SkinMaps.apply` takes it.
"""

from cutis.errors import CutisError
from cutis.maps.edits import Edit
from cutis.optics import parameter

Preset = tuple[Edit, ...]

blood_eighth: Preset = (Edit("blood", "multiply", 0.125),)
blood_half: Preset = (Edit("blood", "multiply", 0.5),)
blood_triple: Preset = (Edit("blood", "multiply", 3.0),)
melanin_half: Preset = (Edit("melanin", "multiply", 0.5),)
melanin_more: Preset = (Edit("melanin", "multiply", 1.5),)
melanin_triple: Preset = (Edit("melanin", "multiply", 3.0),)
melanin_fivefold: Preset = (Edit("melanin", "multiply", 5.0),)
deoxygenated: Preset = (Edit("oxygenation", "set", parameter("oxygenation").low),)
oxygenated: Preset = (Edit("oxygenation", "set", parameter("oxygenation").high),)
thinnest: Preset = (Edit("thickness", "set", parameter("thickness").low),)
thickest: Preset = (Edit("thickness", "set", parameter("thickness").high),)
tanning: Preset = (
    Edit("melanin", "multiply", 1.4),
    Edit("eumelanin", "set", parameter("eumelanin").low),
)
"""Melanin +40 %, all of it pheomelanin, as the paper has it."""
flushing: Preset = (
    Edit("blood", "multiply", 1.7),
    Edit("oxygenation", "set", parameter("oxygenation").high),
)
"""Blood +70 %, fully oxygenated."""
vitiligo: Preset = (Edit("melanin", "set", parameter("melanin").low, where="patches"),)
"""Patches without melanin: procedural ones, or inside a painted mask."""

PRESETS: dict[str, Preset] = {
    "blood-eighth": blood_eighth,
    "blood-half": blood_half,
    "blood-triple": blood_triple,
    "melanin-half": melanin_half,
    "melanin-more": melanin_more,
    "melanin-triple": melanin_triple,
    "melanin-fivefold": melanin_fivefold,
    "deoxygenated": deoxygenated,
    "oxygenated": oxygenated,
    "thinnest": thinnest,
    "thickest": thickest,
    "tanning": tanning,
    "flushing": flushing,
    "vitiligo": vitiligo,
}


def preset(name: str) -> Preset:
    """The preset called `name`; raises CutisError that lists them when there is none."""
    if name not in PRESETS:
        raise CutisError(f"unknown preset {name!r}; known are {', '.join(PRESETS)}")
    return PRESETS[name]
