"""Whether a file says that its RGB is not that of sRGB."""

import OpenImageIO as oiio

REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""Chromaticities x, y of red, green, blue and white of sRGB [iec61966]."""
WIDE_GAMUT_NAMES = ("p3", "adobe", "prophoto", "2020", "aces", "wide gamut", "romm")
"""Parts of the descriptions of ICC profiles whose primaries are not those of sRGB."""


def foreign_space(spec: oiio.ImageSpec) -> str | None:
    """What the file calls its RGB space when that is not sRGB's primaries; None when it is.

    Looks at OpenEXR `chromaticities` and at the description of an ICC profile. A file that says
    nothing counts as sRGB.
    """
    chromaticities = spec.getattribute("chromaticities")
    if chromaticities is not None and len(chromaticities) == len(REC709):
        gaps = (abs(a - b) for a, b in zip(chromaticities, REC709, strict=True))
        if max(gaps) > 0.003:
            red = ", ".join(f"{x:g}" for x in chromaticities[:2])
            return f"RGB with other primaries (red at {red})"
    description = spec.get_string_attribute("ICCProfile:profile_description")
    if any(name in description.lower() for name in WIDE_GAMUT_NAMES):
        return description
    return None
