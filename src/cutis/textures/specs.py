"""Headers of textures to be written: what of a file's own survives, and what must be said anew."""

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.colour.spaces import LINEAR, SRGB, RGBSpace
from cutis.textures.curves import CurveSpace
from cutis.textures.frame import Frame
from cutis.textures.profile import icc_profile
from cutis.textures.texture import Texture
from cutis.textures.turning import turned

ZIP = "zip:1"
"""OpenEXR packed so that every program reads it, in the least time: stronger levels gain 0.4 %."""
PNG_LEVEL = 4
"""A third of the time of zlib's usual 6, for files that are 4 % longer."""
# Other compressions would change texels that nobody touched, or are not in every build.
_LOSSLESS = {
    "tiff": {"none", "lzw", "zip", "packbits"},
    "openexr": {"none", "rle", "zip", "zips", "piz"},
}
# Metadata that means nothing outside the format it came from, as OpenImageIO takes patterns: one by
# one, since it knows no alternatives.
_PRIVATE = (
    *(f"{name}:.*" for name in ("tiff", "png", "jpeg", "openexr", "oiio", "dpx", "psd")),
    *("compression", "planarconfig", "name", "screenWindow.*", "Orientation"),
    "thumbnail.*",
)
# What is true of a whole texture with its MIP levels, and of the colours it had.
_MIP = (
    *("textureformat", "wrapmodes", "fovcot", "oiio:miplevels"),
    *("oiio:SHA-1", "oiio:AverageColor", "oiio:ConstantColor"),
)
# What says which space the colours are in.
_SPACE = (
    *("ICCProfile", "ICCProfile:.*", "chromaticities", "colorInteropID", "oiio:ColorSpace"),
    *("oiio:Gamma", "CICP", "dpx:Transfer", "dpx:Colorimetric", "Exif:ColorSpace"),
    *("photoshop:ICCProfile", "acesImageContainerFlag", "adoptedNeutral", "whiteLuminance"),
    "([^:/]*[:/])*colou?r_? ?space",
)
# Where profiles go; the others tell a space in their own ways, and DPX hardly any.
_PROFILED = ("png", "jpeg", "tiff", "tx")


def header(source: Texture, fitted: Texture, file_format: str, frame: Frame) -> oiio.ImageSpec:
    """That of `source` as far as it fits the format, for pixels like those of `fitted`."""
    spec = oiio.ImageSpec() if source.spec is None else source.spec.copy()
    same_format = source.spec is not None and source.format == file_format
    mixed = spec.channelformats if same_format else ()
    count = len(fitted.channels)
    if (spec.height, spec.width) != frame.shape or not same_format:
        frame.to(spec)
        spec.tile_width = spec.tile_height = spec.tile_depth = 0
    if same_format:
        spec = turned(spec, source.turned)
    spec.nchannels, spec.depth, spec.full_depth = count, 1, 1
    spec.channelnames = fitted.channels
    spec.set_format(oiio.TypeDesc(_type_name(fitted.pixels)))
    if len(mixed) == count and fitted.pixels.dtype == np.float32:
        spec.channelformats = mixed
    names = [name.lower() for name in fitted.channels]
    spec.alpha_channel = names.index("a") if "a" in names else -1
    spec.z_channel = names.index("z") if "z" in names else -1
    _erase(spec, _MIP if same_format else (*_MIP, *_PRIVATE))
    if fitted.space != source.space:
        _erase(spec, _SPACE)
    other = not same_format or fitted.space != source.space or source.origin == "given"
    aces = spec.getattribute("acesImageContainerFlag") is not None
    _erase(spec, ("acesImageContainerFlag",))  # such a container is not packed with ZIP
    if other or aces or file_format in _PROFILED:  # where the writer has other words than the file
        _tell_space(spec, fitted, file_format)
    _erase(spec, ("oiio:UnassociatedAlpha", "oiio:subimages"))
    if not same_format or fitted.pixels.dtype != source.pixels.dtype:
        _erase(spec, ("oiio:BitsPerSample",))
    if spec.alpha_channel >= 0 and not fitted.associated:
        spec.attribute("oiio:UnassociatedAlpha", 1)
    if file_format == "tiff" and fitted.pixels.dtype == np.float16:
        spec.attribute("tiff:half", 1)
    if file_format in _LOSSLESS and spec.getattribute("compression") not in _LOSSLESS[file_format]:
        spec.attribute("compression", "zip")
    if file_format == "openexr" and spec.get_string_attribute("compression") == "zip":
        spec.attribute("compression", ZIP)
    if file_format == "png":
        spec.attribute("png:compressionLevel", PNG_LEVEL)
    if file_format == "jpeg":
        spec.attribute("compression", "jpeg:98")
        if not same_format:
            spec.attribute("jpeg:subsampling", "4:4:4")
    return spec


def _tell_space(spec: oiio.ImageSpec, fitted: Texture, file_format: str) -> None:
    """Which space the colours are in, where the format has words for it and none are there."""
    space, known = fitted.space, fitted.space.chromaticities
    if file_format == "openexr" and known is not None and not space.encoded:
        spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), known)
    if file_format == "dpx" and space == LINEAR:
        spec.attribute("dpx:Transfer", "Linear")
    usual = LINEAR if fitted.pixels.dtype.kind == "f" else SRGB
    if (
        file_format in _PROFILED
        and isinstance(space, RGBSpace | CurveSpace)
        and space != usual
        and spec.getattribute("ICCProfile") is None
        and not (file_format == "png" and _png_says(spec, space))
    ):
        _erase(spec, ("oiio:ColorSpace", "oiio:Gamma", "Exif:ColorSpace"))
        profile = np.frombuffer(icc_profile(space), np.uint8)
        spec.attribute("ICCProfile", oiio.TypeDesc(f"uint8[{len(profile)}]"), profile)


def _png_says(spec: oiio.ImageSpec, space: RGBSpace | CurveSpace) -> bool:
    """Whether the writer will say the space by PNG's own chunks: cICP, or a gamma of 1."""
    gamma = spec.get_string_attribute("oiio:ColorSpace") == "lin_rec709_scene"
    return spec.getattribute("CICP") is not None or (space == LINEAR and gamma)


def _erase(spec: oiio.ImageSpec, names: tuple[str, ...]) -> None:
    for name in names:
        spec.erase_attribute(name)


def _type_name(pixels: NDArray[np.generic]) -> str:
    return {"float16": "half", "float32": "float"}.get(pixels.dtype.name, pixels.dtype.name)
