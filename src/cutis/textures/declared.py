"""Which colour space a file says it is in, by every place where its format has words for it.

Each format's places are asked in the order that its standard gives; the first that names a space
counts. Places that name none, and those that no standard knows, are told of and not believed.
"""

import contextlib
from collections.abc import Iterator

import numpy as np
import OpenImageIO as oiio

from cutis.colour.spaces import (
    ACES2065_1,
    D65,
    LINEAR,
    P3,
    REC709,
    SRGB,
    RGBSpace,
    Space,
    rgb_space,
)
from cutis.errors import CutisError
from cutis.textures import ifd
from cutis.textures.colorimetry import (
    ADOBE,
    SLACK,
    Statement,
    by_gamma,
    cicp,
    colorimetry,
    exif,
    nearest,
    png_chunks,
)
from cutis.textures.curves import PowerCurve, alike, curve_space, one_of_ours
from cutis.textures.headers import Header
from cutis.textures.icc import icc_space
from cutis.textures.ifd import Directory
from cutis.textures.problem import shorten
from cutis.textures.spaces import colour_space

LOGARITHMIC = ("printing density", "logarithmic", "kodaklog", "adx")
"""Transfer characteristics of DPX files that hold film densities, in lower case."""
UNTOLD = "assumed, the file says nothing"
# Names by which the parts of a colorInteropID mean a space [interop].
_PRIMARIES = {
    "rec709": REC709, "p3d65": P3, "rec2020": rgb_space("Rec.2020").primaries, "adobergb": ADOBE,
    "ap0": ACES2065_1.primaries, "ap1": rgb_space("ACEScg").primaries,
}  # fmt: skip
_GAMMAS = {"g18": 1.8, "g22": 2.2, "g24": 2.4, "g26": 2.6}
_TEXT_KEYS = (b"oiio:colorspace", b"colorspace", b"color space", b"colourspace", b"colour space")
_ATTRIBUTES = ("colorspace", "color_space", "color space")
_VIDEO = ("smpte 274m", "itu-r 709-4", "rec709")


def declared_space(
    spec: oiio.ImageSpec, header: Header, part: int, floating: bool
) -> tuple[Space, str, list[str]]:
    """The space that a file says it is in, else sRGB for integers and linear sRGB for floats.

    The second value says where it is from, the third are notes on what it also says, for people.
    Raises ValueError, saying what to do, where the file is in a space that cannot be told.
    """
    usual = LINEAR if floating else SRGB
    told = list(_statements(spec, header, part, floating))
    chosen = next((one for one in told if one.space is not None), None)
    notes = list(_unused(spec)) if header.format == "openexr" else []
    if chosen is None or chosen.space is None:
        said = "; ".join(f"{one.where} {one.says}" for one in told)
        return usual, f"assumed, {said}" if said else UNTOLD, notes
    first = told.index(chosen)
    notes += [f"{one.where} {one.says}: not used" for one in told[:first]]
    for one in told[first + 1 :]:
        if one.space is not None and not alike(one.space, chosen.space):
            notes.append(f"{one.where} says {one.space.name}: overruled by {chosen.where}")
    return chosen.space, chosen.where, notes


def _statements(
    spec: oiio.ImageSpec, header: Header, part: int, floating: bool
) -> Iterator[Statement]:
    page = header.pages[part] if part < len(header.pages) else Directory()
    if header.format == "png":
        yield from cicp(header.chunks)
        yield from _profile(spec, header.profile)
        yield from png_chunks(header.chunks)
        yield from exif(page, floating)
        for key in _TEXT_KEYS:
            if key in header.texts:
                said = shorten(header.texts[key].decode("utf-8", "backslashreplace"))
                yield Statement(f"its text {key.decode()}", says=f"says '{said}', which is no word "
                                "of the format and not believed")  # fmt: skip
    elif header.format == "openexr":
        yield from _openexr(spec)
    elif header.format == "dpx":
        yield from _dpx(spec)
    else:
        yield from _profile(spec, header.profile or ifd.PROFILE in page.tags)
        if header.format == "tiff":
            yield from colorimetry(page, floating)
        yield from exif(page, floating, numbers=header.format != "tiff")
    yield from _xmp(spec, page, header)


def _profile(spec: oiio.ImageSpec, there: bool) -> Iterator[Statement]:
    """The ICC profile; files may call other things so, of any type."""
    profile = np.asarray(spec.getattribute("ICCProfile"))
    if profile.ndim == 1 and profile.dtype == np.uint8:
        try:
            yield Statement("its ICC profile", icc_space(profile.tobytes()))
        except ValueError as error:
            yield Statement("its ICC profile", says=f"cannot be used: it is {error}")
    elif there:
        yield Statement("its ICC profile", says="cannot be used: it is damaged")


def _openexr(spec: oiio.ImageSpec) -> Iterator[Statement]:
    """colorInteropID, which supersedes chromaticities [interop]; the mark of ACES; chromaticities.

    Then what programs write of their own: names of spaces, as OpenImageIO's.
    """
    token = _text(spec, "colorInteropID")
    if token not in ("", "unknown"):
        yield _named("its colorInteropID", token)
    if spec.get_int_attribute("acesImageContainerFlag") == 1:
        yield Statement("its acesImageContainerFlag", ACES2065_1)
    numbers = spec.getattribute("chromaticities")
    if isinstance(numbers, tuple) and len(numbers) == 8:
        x = [float(v) for v in numbers]
        red, green, blue, white = zip(x[::2], x[1::2], strict=True)
        try:
            yield Statement("its chromaticities", nearest((red, green, blue), white))
        except ValueError as error:
            raise ValueError(f"has {error}; name its space with --colorspace") from error
    elif numbers is not None:
        yield Statement("its chromaticities", says="are no eight numbers")
    yield from _profile(spec, False)
    inferred = token or spec.get_int_attribute("acesImageContainerFlag") == 1
    for name in _names(spec):
        if inferred and name.lower() == "oiio:colorspace":
            continue  # the reader's own conclusion
        yield _named(f"its {shorten(name)}", _text(spec, name))


def _names(spec: oiio.ImageSpec) -> list[str]:
    """Attributes that other programs call colour space, OpenImageIO's first."""
    found = []
    for attribute in spec.extra_attribs:
        last = attribute.name.replace("/", ":").rpartition(":")[2].lower()
        if last in _ATTRIBUTES and _text(spec, attribute.name):
            found.append(attribute.name)
    return sorted(found, key=lambda name: (name.lower() != "oiio:colorspace", name))


def _named(where: str, token: str) -> Statement:
    """A space by its name."""
    if token.lower() in ("data", "raw", "non-color", "none"):
        return Statement(where, says=f"says '{shorten(token)}', which is no colour")
    if token.isascii() and token.isprintable() and len(token) <= 100:
        with contextlib.suppress(CutisError, ValueError):
            return Statement(where, _interop(token) or colour_space(token, ""))
    return Statement(where, says=f"says '{shorten(token)}', which is not known")


def _interop(token: str) -> Space | None:
    """The space of an identifier such as g22_adobergb_scene; None for other names."""
    parts = token.split("_")
    if len(parts) != 3 or parts[1] not in _PRIMARIES or parts[2] not in ("scene", "display"):
        return None
    curve, primaries, _ = parts
    aces = rgb_space("ACEScg").white if primaries in ("ap0", "ap1") else D65
    space = RGBSpace(token, _PRIMARIES[primaries], aces)
    if curve in ("lin", "srgb"):
        return one_of_ours(space.with_curve(curve == "srgb"))
    if curve in _GAMMAS:
        return curve_space(token, space.primaries, space.white, PowerCurve(_GAMMAS[curve]))
    return None


def _unused(spec: oiio.ImageSpec) -> Iterator[str]:
    """What an OpenEXR also says of colour, and what becomes of it."""
    luminance = spec.getattribute("whiteLuminance")
    if isinstance(luminance, int | float):
        yield f"its whiteLuminance ({luminance:g} cd/m²) is not used: albedo is a share of light"
    neutral = spec.getattribute("adoptedNeutral")
    if isinstance(neutral, tuple) and len(neutral) == 2:
        x, y = (float(v) for v in neutral)
        if max(abs(x - D65[0]), abs(y - D65[1])) >= SLACK:
            yield f"its adoptedNeutral ({x:.4g}, {y:.4g}) is not used; --white balances"


def _dpx(spec: oiio.ImageSpec) -> Iterator[Statement]:
    """The transfer characteristic, then the colorimetric specification [smpte268]."""
    transfer = _text(spec, "dpx:Transfer").lower()
    if transfer in LOGARITHMIC:
        raise ValueError(
            f"holds film densities ({transfer}); name its space with --colorspace, such as ADX10"
        )
    if transfer == "linear":
        yield Statement("its transfer characteristic", LINEAR)
    gamma = spec.getattribute("oiio:Gamma")  # there where the characteristic is the user's own
    if isinstance(gamma, int | float) and 0.1 <= gamma <= 10:
        yield Statement("its gamma", by_gamma(REC709, D65, float(gamma)))
    for where, said in (
        ("its transfer characteristic", transfer),
        ("its colorimetric characteristic", _text(spec, "dpx:Colorimetric").lower()),
    ):
        if said in _VIDEO:
            yield Statement(f"{where} ({said}, taken for sRGB's)", SRGB)
        elif said not in ("", "linear", "user defined", "undefined"):
            yield Statement(where, says=f"says '{shorten(said)}', which is not used")


def _xmp(spec: oiio.ImageSpec, page: Directory, header: Header) -> Iterator[Statement]:
    """XMP names the profile that was embedded, which may have been of other colours than these."""
    name = _text(spec, "photoshop:ICCProfile")
    if name:
        yield Statement("its XMP", says=f"names the profile '{shorten(name)}', which is not there "
                        "and not believed")  # fmt: skip
    number = spec.get_int_attribute("Exif:ColorSpace")
    if number and not page.exif.get(ifd.EXIF_COLOUR_SPACE) and header.format != "openexr":
        what = {1: "sRGB", 2: "Adobe RGB", 0xFFFF: "uncalibrated"}.get(number, str(number))
        yield Statement("its XMP", says=f"says {what}, which is not believed")


def _text(spec: oiio.ImageSpec, name: str) -> str:
    """An attribute if it is text, else ""."""
    try:
        found = spec.getattribute(name)
    except UnicodeError:
        return ""
    return found.strip() if isinstance(found, str) else ""
