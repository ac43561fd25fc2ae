"""Which colour space a file is in: as asked for, as it says itself, or as is usual."""

import OpenImageIO as oiio

from cutis.colour.spaces import LINEAR, REC709, SRGB, RGBSpace, Space, rgb_space
from cutis.errors import CutisError
from cutis.textures.icc import icc_space
from cutis.textures.ocio import configured, ocio_names, ocio_space

SLACK = 3e-3
"""Chromaticities that differ by less are the same: files round them."""
LOGARITHMIC = ("printing density", "logarithmic", "kodaklog")
"""Transfer characteristics of DPX files that hold film densities, in lower case."""


def colour_space(name: str, config: str | None = None) -> Space:
    """The space called `name`: a colour space, role or alias of OpenColorIO, or one of ours.

    With a configuration, `config` or $OCIO, its names come first; without, sRGB, linear, ACEScg,
    Display P3 and Rec.2020 are built in and the rest are those of OpenColorIO's ACES studio
    configuration. Raises CutisError for a name that neither has.
    """
    config = config or configured()
    if config is not None:
        found = ocio_space(name, config)
        if found is not None:
            return found
    try:
        return rgb_space(name)
    except CutisError:
        other = None if config is not None else ocio_space(name)
        if other is not None:
            return other
    listed = [*("sRGB", "linear", "ACEScg", "Display P3", "Rec.2020"), *ocio_names(config)]
    shown = ", ".join(dict.fromkeys(listed))
    where = f" in {config}" if config else ""
    raise CutisError(f"unknown colour space {name!r}{where}; known are {shown}")


def declared_space(spec: oiio.ImageSpec, floating: bool) -> tuple[Space, str]:
    """The space that a file says it is in, else sRGB for integers and linear sRGB for floats.

    Looks at the ICC profile, OpenEXR's `chromaticities` and `colorInteropID`, DPX's transfer
    characteristic. The second value says where it is from, for people. Raises ValueError, saying
    what to do, where the file is in a space that cannot be told.
    """
    usual = LINEAR if floating else SRGB
    profile = spec.getattribute("ICCProfile")
    if profile is not None:
        try:
            return icc_space(bytes(bytearray(profile))), "its ICC profile"
        except ValueError as error:
            return usual, f"assumed, its ICC profile cannot be used: it is {error}"
    numbers = spec.getattribute("chromaticities")
    if numbers is not None and len(numbers) == 8:
        return _by_chromaticities(tuple(float(v) for v in numbers)), "its chromaticities"
    token = spec.get_string_attribute("colorInteropID")
    if token and token not in ("unknown", "data"):
        try:
            return colour_space(token), "its colorInteropID"
        except CutisError:
            pass
    transfer = spec.get_string_attribute("dpx:Transfer").lower()
    if transfer in LOGARITHMIC:
        raise ValueError(
            f"holds film densities ({transfer}); name its space with --colorspace, such as ADX10"
        )
    if transfer == "linear":
        return LINEAR, "its transfer characteristic"
    return usual, "assumed, the file says nothing"


def _by_chromaticities(numbers: tuple[float, ...]) -> RGBSpace:
    for known in (LINEAR, rgb_space("ACEScg"), rgb_space("Rec.2020"), _linear_p3()):
        if max(abs(a - b) for a, b in zip(numbers, known.chromaticities, strict=True)) < SLACK:
            return known
    red, green, blue, white = ((numbers[i], numbers[i + 1]) for i in (0, 2, 4, 6))
    space = RGBSpace(f"RGB with red at {red[0]:g}, {red[1]:g}", (red, green, blue), white)
    try:
        usable = abs(float(space.matrix.sum())) < 1e6
    except (ArithmeticError, ValueError):
        usable = False
    if not usable:
        raise ValueError(
            "has chromaticities that are no RGB space; name its space with --colorspace"
        )
    return space


def _linear_p3() -> RGBSpace:
    return rgb_space("Display P3").with_curve(False)


def sibling(space: Space, encoded: bool) -> Space:
    """The space for the same colours in a file of the other kind: encoded integers, linear floats.

    The same primaries where they are sRGB's or P3's or the result is linear; else sRGB's.
    """
    if space.encoded == encoded:
        return space
    if isinstance(space, RGBSpace) and (
        not encoded or space.primaries == REC709 or space == _linear_p3()
    ):
        return space.with_curve(encoded)
    return SRGB if encoded else LINEAR
