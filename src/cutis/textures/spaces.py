"""Which colour space a file is in: as asked for, as it says itself, or as is usual."""

import contextlib
import difflib

import numpy as np
import OpenImageIO as oiio

from cutis.colour.spaces import (
    ACES2065_1,
    ALIASES,
    LINEAR,
    REC709,
    SPACES,
    SRGB,
    RGBSpace,
    Space,
    rgb_space,
)
from cutis.errors import CutisError
from cutis.textures.icc import icc_space
from cutis.textures.ocio import configured, ocio_names, ocio_space

SLACK = 3e-3
"""Chromaticities that differ by less are the same: files round them."""
LOGARITHMIC = ("printing density", "logarithmic", "kodaklog")
"""Transfer characteristics of DPX files that hold film densities, in lower case."""
UNTOLD = "assumed, the file says nothing"
MOST = 8
"""Names shown of the many that there are."""


def colour_space(name: str, config: str | None = None) -> Space:
    """The space called `name`: a colour space, role or alias of OpenColorIO, or one of ours.

    With a configuration, `config` or $OCIO, its names come first; without, or with `config` "",
    sRGB, linear, ACEScg, Display P3 and Rec.2020 are ours and the rest are those of OpenColorIO's
    ACES studio configuration. Raises CutisError for a name that neither has.
    """
    config = (configured() if config is None else config) or None
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
    where = f" in {config}" if config else ""
    raise CutisError(f"unknown colour space {name!r}{where}; {_suggestion(name, config)}")


def _suggestion(name: str, config: str | None) -> str:
    """Names close to `name`, else some of those known: configurations hold hundreds."""
    spaces, others = ocio_names(config)
    if not spaces:
        ours = ", ".join(space.name for space in SPACES)
        return f"known are {ours}; others need OpenColorIO: pip install opencolorio"
    spaces = list(dict.fromkeys([*(space.name for space in SPACES), *spaces]))
    by_case = {known.lower(): known for known in [*others, *ALIASES, *spaces]}
    close = difflib.get_close_matches(name.lower(), by_case, n=3, cutoff=0.6)
    if close:
        return f"did you mean {' or '.join(by_case[one] for one in close)}?"
    shown, more = ", ".join(spaces[:MOST]), len(spaces) - MOST
    return f"known are {shown}" + (f" and {more} more" if more > 0 else "")


def declared_space(spec: oiio.ImageSpec, file_format: str, floating: bool) -> tuple[Space, str]:
    """The space that a file says it is in, else sRGB for integers and linear sRGB for floats.

    Looks at the ICC profile, OpenEXR's `chromaticities` and `colorInteropID`, PNG's cICP and gAMA,
    DPX's transfer characteristic. The second value says where it is from, for people. Raises
    ValueError, saying what to do, where the file is in a space that cannot be told.
    """
    usual = LINEAR if floating else SRGB
    profile = _profile(spec)
    if profile is not None:
        try:
            return icc_space(profile), "its ICC profile"
        except ValueError as error:
            return usual, f"assumed, its ICC profile cannot be used: it is {error}"
    numbers = spec.getattribute("chromaticities")
    if isinstance(numbers, tuple) and len(numbers) == 8:
        return _by_chromaticities(tuple(float(v) for v in numbers)), "its chromaticities"
    token = spec.get_string_attribute("colorInteropID")
    if token.isascii() and token not in ("", "unknown", "data"):
        with contextlib.suppress(CutisError):
            return colour_space(token, ""), "its colorInteropID"
        return usual, f"assumed, its colorInteropID {token[:40]!r} is not known"
    if file_format == "png":
        return _of_png(spec, usual)
    transfer = spec.get_string_attribute("dpx:Transfer").lower()
    if transfer in LOGARITHMIC:
        raise ValueError(
            f"holds film densities ({transfer}); name its space with --colorspace, such as ADX10"
        )
    if transfer == "linear":
        return LINEAR, "its transfer characteristic"
    return usual, UNTOLD


def _of_png(spec: oiio.ImageSpec, usual: Space) -> tuple[Space, str]:
    """By cICP and gAMA, which OpenImageIO has turned into the name of a space.

    A gamma of 2.2 is what the format's own specification gives for sRGB.
    """
    token = spec.get_string_attribute("oiio:ColorSpace")
    chunk = "cICP" if spec.getattribute("CICP") is not None else "gAMA"
    if token in ("", "srgb_rec709_scene", "g22_rec709_scene"):
        return usual, "its cICP" if token and chunk == "cICP" else UNTOLD
    with contextlib.suppress(CutisError):
        return colour_space(token, ""), f"its {chunk}"
    return usual, f"assumed, its {chunk} says {token}, which is not known"


def _profile(spec: oiio.ImageSpec) -> bytes | None:
    """The bytes of an ICC profile; files may call other things so, of any type."""
    profile = np.asarray(spec.getattribute("ICCProfile"))
    return profile.tobytes() if profile.ndim == 1 and profile.dtype == np.uint8 else None


def _by_chromaticities(numbers: tuple[float, ...]) -> RGBSpace:
    for known in (LINEAR, rgb_space("ACEScg"), rgb_space("Rec.2020"), _linear_p3(), ACES2065_1):
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
