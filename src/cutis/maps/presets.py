"""Named edits: those that the paper shows, with its amounts [aliaga2022], and of four conditions.

The amounts of those four are of physiology; they make pictures, not diagnoses (docs/guide.md).

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
jaundice: Preset = (Edit("bilirubin", "set", 0.04),)
"""A serum of 0.2 g/L; the dermis then holds about a fifth of that (docs/decisions/0024)."""
carotenaemia: Preset = (Edit("carotene", "set", 0.015),)
"""Five times the β-carotene of a usual epidermis [vahlquist1982]."""
cyanosis: Preset = (Edit("oxygenation", "multiply", 0.4),)
"""From 0.75 to 0.3: more than 50 g/L of deoxygenated haemoglobin in the vessels
[lundsgaard1923]."""
methaemoglobinaemia: Preset = (Edit("methaemoglobin", "set", 0.3),)
"""Three times what is seen at first, 15 g/L or a tenth of all haemoglobin [finch1948]."""

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
    "jaundice": jaundice,
    "carotenaemia": carotenaemia,
    "cyanosis": cyanosis,
    "methaemoglobinaemia": methaemoglobinaemia,
}


def preset(name: str) -> Preset:
    """The preset called `name`; raises CutisError that lists them when there is none."""
    if name not in PRESETS:
        raise CutisError(f"unknown preset {name!r}; known are {', '.join(PRESETS)}")
    return PRESETS[name]
