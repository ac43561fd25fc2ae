"""Colour spaces by numbers in headers: code points, chromaticities, exponents, tables."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutis.colour.spaces import (
    ACES2065_1,
    D65,
    LINEAR,
    P3,
    REC709,
    SRGB,
    Primaries,
    RGBSpace,
    Space,
    rgb_space,
)
from cutis.textures import ifd
from cutis.textures.curves import PowerCurve, TableCurve, curve_space, one_of_ours, usable
from cutis.textures.ifd import Directory, whole

SLACK = 3e-3
"""Chromaticities that differ by less are the same: files round them."""
ADOBE: Primaries = ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06))
ADOBE_GAMMA = 563 / 256
"""Adobe RGB (1998) [adobergb]."""
XY = tuple[float, float]
_PAL: Primaries = ((0.64, 0.33), (0.29, 0.60), (0.15, 0.06))
_SMPTE: Primaries = ((0.63, 0.34), (0.31, 0.595), (0.155, 0.07))
_KNOWN = (
    LINEAR,
    rgb_space("ACEScg"),
    rgb_space("Rec.2020"),
    rgb_space("Display P3").with_curve(False),
    ACES2065_1,
    RGBSpace("Adobe RGB primaries", ADOBE, D65),
)
# Names and primaries of cICP's numbers, all under D65, and what its curves are [h273].
_CICP_PRIMARIES: dict[int, tuple[str, Primaries]] = {
    1: ("Rec.709", REC709), 5: ("Rec.601", _PAL), 6: ("Rec.601", _SMPTE), 7: ("SMPTE 240M", _SMPTE),
    9: ("Rec.2020", rgb_space("Rec.2020").primaries), 12: ("P3", P3), 22: ("EBU", _PAL),
}  # fmt: skip
_CICP_GAMMA = {4: 2.2, 5: 2.8}
_CICP_VIDEO, _CICP_LINEAR, _CICP_SRGB = (1, 6, 14, 15), 8, 13
_CICP_HDR = {16: "PQ", 18: "HLG"}
_UNCALIBRATED = 0xFFFF


@dataclass(frozen=True)
class Statement:
    """What a place says: `where` it stands, and the `space`, or in words what it says instead."""

    where: str
    space: Space | None = None
    says: str = ""


def cicp(chunks: dict[bytes, bytes]) -> Iterator[Statement]:
    """PNG's coding-independent code points, which come first of all [png]."""
    if b"cICP" not in chunks:
        return
    where, code = "its cICP", chunks[b"cICP"]
    if len(code) != 4:
        yield Statement(where, says="cannot be used: it is damaged")
        return
    primaries, transfer, matrix, full = code
    numbers = "-".join(map(str, code))
    if transfer in _CICP_HDR:
        raise ValueError(
            f"holds HDR video ({_CICP_HDR[transfer]}, by its cICP); name its space with "
            "--colorspace, such as rec2100_pq_display, or export it as sRGB"
        )
    if matrix != 0 or full != 1 or primaries not in _CICP_PRIMARIES:
        yield Statement(where, says=f"says {numbers}, which is not supported")
        return
    name, chromaticities = _CICP_PRIMARIES[primaries]
    space = RGBSpace(name, chromaticities, D65)
    if transfer == _CICP_LINEAR:
        yield Statement(where, one_of_ours(space))
    elif transfer in (_CICP_SRGB, *_CICP_VIDEO):
        video = " (a curve of video, taken for sRGB's)" if transfer in _CICP_VIDEO else ""
        yield Statement(f"{where}{video}", one_of_ours(space.with_curve(True)))
    elif transfer in _CICP_GAMMA:
        gamma = _CICP_GAMMA[transfer]
        named = f"{name}, gamma {gamma:g}"
        yield Statement(where, curve_space(named, chromaticities, D65, PowerCurve(gamma)))
    else:
        yield Statement(where, says=f"says {numbers}, which is not supported")


def png_chunks(chunks: dict[bytes, bytes]) -> Iterator[Statement]:
    """sRGB, then gAMA and cHRM [png]. A gamma of 2.2 of Rec.709 is what sRGB files say too."""
    if b"sRGB" in chunks:
        yield Statement("its sRGB chunk", SRGB)
    there = [name for name in (b"gAMA", b"cHRM") if name in chunks]
    if not there:
        return
    where = f"its {' and '.join(name.decode() for name in there)}"
    try:
        gamma, primaries, white = None, REC709, D65
        if b"gAMA" in chunks:
            gamma = 1e5 / struct.unpack(">I", chunks[b"gAMA"])[0]
        if b"cHRM" in chunks:
            x = [v / 1e5 for v in struct.unpack(">8I", chunks[b"cHRM"])]
            white, *rest = zip(x[::2], x[1::2], strict=True)
            primaries = tuple(rest)
        yield Statement(where, by_gamma(primaries, white, gamma))
    except (ArithmeticError, ValueError, struct.error):
        yield Statement(where, says="cannot be used: its numbers make no sense")


def by_gamma(primaries: Primaries, white: XY, gamma: float | None) -> Space:
    """A space by chromaticities and exponent; sRGB's curve without one."""
    known = nearest(primaries, white)
    if gamma is None or (abs(gamma - 2.2) < 0.01 and known == LINEAR):
        return one_of_ours(known.with_curve(True))
    if abs(gamma - 1) < 1e-3:
        return known
    return curve_space(
        f"{_label(known)}, gamma {gamma:.4g}", known.primaries, known.white, PowerCurve(gamma)
    )


def exif(page: Directory, floating: bool, numbers: bool = True) -> Iterator[Statement]:
    """Exif: ColorSpace, with the index of the interoperability rules for Adobe RGB [exif] [dcf].

    Without one, and with `numbers`, chromaticities, gamma and transfer function.
    """
    number = whole(page.exif, ifd.EXIF_COLOUR_SPACE, -1)
    index = page.interop.get(ifd.INTEROP_INDEX, b"")
    adobe = isinstance(index, bytes) and index.startswith(b"R03")
    where = "its EXIF"
    if floating and number > 0:
        yield Statement(where, says="says a space of integers, and its values are floats")
    elif number == 2 or adobe:
        yield Statement(where, curve_space("Adobe RGB (1998)", ADOBE, D65, PowerCurve(ADOBE_GAMMA)))
    elif number == 1:
        yield Statement(where, SRGB)
    else:
        found = list(colorimetry(page, floating)) if numbers else []
        yield from found
        if number == _UNCALIBRATED and not found:
            yield Statement(where, says="says uncalibrated")
        elif number > 0 and number != _UNCALIBRATED:
            yield Statement(where, says=f"says colour space {number}, which is not known")


def colorimetry(page: Directory, floating: bool) -> Iterator[Statement]:
    """WhitePoint, PrimaryChromaticities and TransferFunction of TIFF and Exif [tiff6].

    Without a transfer function TIFF's is a gamma of 2.2.
    """
    names = {
        ifd.WHITE_POINT: ("WhitePoint", 2),
        ifd.PRIMARIES: ("PrimaryChromaticities", 6),
        ifd.TRANSFER_FUNCTION: ("TransferFunction", 1),
        ifd.EXIF_GAMMA: ("Gamma", 1),
    }
    found = {**page.tags, **{k: v for k, v in page.exif.items() if k == ifd.EXIF_GAMMA}}
    there = [tag for tag in names if tag in found]
    if not there:
        return
    where = f"its {' and '.join(names[tag][0] for tag in there)}"
    try:
        numbers = {tag: np.array(found[tag], dtype=np.float64) for tag in there}
        if any(len(numbers[tag]) < names[tag][1] or not np.isfinite(numbers[tag]).all()
               for tag in there):  # fmt: skip
            raise ValueError("too few numbers")
        chromatic = ifd.PRIMARIES in there and ifd.WHITE_POINT in there
        shaped = ifd.TRANSFER_FUNCTION in there or ifd.EXIF_GAMMA in there
        if not chromatic and not shaped:
            yield Statement(where, says="is there alone and not used")
            return
        primaries, white = REC709, D65
        if chromatic:
            primaries = tuple((x, y) for x, y in numbers[ifd.PRIMARIES][:6].reshape(3, 2).tolist())
            white = (float(numbers[ifd.WHITE_POINT][0]), float(numbers[ifd.WHITE_POINT][1]))
        if floating:
            yield Statement(where, nearest(primaries, white))
        elif ifd.TRANSFER_FUNCTION in there:
            curves = _transfer(numbers[ifd.TRANSFER_FUNCTION])
            known = nearest(primaries, white)
            name = f"{_label(known)}, with a curve of its own"
            yield Statement(where, curve_space(name, known.primaries, known.white, *curves))
        else:
            gamma = float(numbers[ifd.EXIF_GAMMA][0]) if ifd.EXIF_GAMMA in there else 2.2
            yield Statement(where, by_gamma(primaries, white, gamma))
    except (ArithmeticError, TypeError, ValueError):
        yield Statement(where, says="cannot be used: its numbers make no sense")


def _transfer(table: NDArray[np.float64]) -> list[TableCurve]:
    """One curve or three from a table of light for each code."""
    length = len(table)
    parts = [table] if length & (length - 1) == 0 else np.split(table, 3)
    return [TableCurve(part / 65535) for part in parts]


def _label(space: RGBSpace) -> str:
    """What its primaries are called."""
    labels = {"linear": "Rec.709", "Display P3, no curve": "P3", "Adobe RGB primaries": "Adobe RGB"}
    return labels.get(space.name, space.name)


def nearest(primaries: Primaries, white: XY) -> RGBSpace:
    """The linear space of these chromaticities; one of ours where rounding explains the difference.

    Raises ValueError where they are no RGB space.
    """
    numbers = [v for xy in (*primaries, white) for v in xy]
    for known in _KNOWN:
        if max(abs(a - b) for a, b in zip(numbers, known.chromaticities, strict=True)) < SLACK:
            return known
    red = primaries[0]
    return usable(RGBSpace(f"RGB with red at {red[0]:g}, {red[1]:g}", primaries, white))
