"""Pictures stored turned, in one of eight ways that Exif numbers [exif]."""

import re
from typing import Any, Literal

import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.textures.frame import whole_frame
from cutis.textures.headers import Header
from cutis.textures.ifd import ORIENTATION, XMP, Directory

Orientation = Literal["auto", "ignore"]
"""Whether a picture is turned as its orientation tag says, or kept in the order it is stored in."""
TURNS = {
    2: "mirrored",
    3: "turned by 180°",
    4: "mirrored upside down",
    5: "mirrored and turned by 90° to the left",
    6: "turned by 90° to the right",
    7: "mirrored and turned by 90° to the right",
    8: "turned by 90° to the left",
}
"""What makes the picture of what is stored, by the number of the orientation tag."""
_XMP_ORIENTATION = re.compile(rb"tiff:Orientation\s*(?:=\s*[\"']|>)\s*([2-8])")


def orientation_of(
    spec: oiio.ImageSpec, header: Header, part: int, wanted: Orientation
) -> tuple[int, list[str]]:
    """How a picture is turned to be upright, as Exif numbers it, 1 for not at all; and notes."""
    page = header.pages[part] if part < len(header.pages) else Directory()
    number = page.number(ORIENTATION, 1)
    if header.format in ("dpx", "openexr"):
        number = int(spec.get_int_attribute("Orientation", 1))
    if number in TURNS:
        if header.format in ("openexr", "psd"):
            what = f"its orientation tag ({number}) is not applied: viewers of such files do not"
            return 1, [what]
        if wanted == "ignore":
            return 1, [f"its orientation tag ({number}) is ignored, as asked for"]
        what = f"{TURNS[number]}, as its orientation tag ({number}) says"
        return number, [f"{what}; --orientation ignore keeps the order as stored"]
    in_xmp = _XMP_ORIENTATION.search(header.xmp or page.text(XMP))
    if in_xmp is not None and page.number(ORIENTATION, 0) == 0:
        told = in_xmp[1].decode()
        return 1, [f"its XMP says orientation {told}: not applied, as most viewers do not"]
    return 1, []


def turned(stored: oiio.ImageSpec, orientation: int) -> oiio.ImageSpec:
    """The header of the same picture, upright, and the reverse; it keeps its orientation tag."""
    spec = stored.copy()
    if orientation >= 5:
        height, width = stored.width, stored.height
        whole_frame((height, width)).to(spec)
        spec.tile_width, spec.tile_height = stored.tile_height, stored.tile_width
        for one, other in (("XResolution", "YResolution"), ("YResolution", "XResolution")):
            density = stored.getattribute(other)
            if isinstance(density, int | float):
                spec.attribute(one, float(density))
    return spec


def upright(stored: NDArray[Any], orientation: int) -> NDArray[Any]:
    """The picture (H, W, …) of what is stored, a view."""
    if orientation >= 5:
        stored = stored.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        stored = stored[:, ::-1]
    if orientation in (3, 4, 7, 8):
        stored = stored[::-1]
    return stored


def as_stored(picture: NDArray[Any], orientation: int) -> NDArray[Any]:
    """The inverse of `upright`, a view."""
    return upright(picture, {6: 8, 8: 6}.get(orientation, orientation))
