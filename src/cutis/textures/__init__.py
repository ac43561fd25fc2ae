"""Image files: textures as stored, masks and named channels, read and written without surprises."""

from typing import Any

from cutis.moved import moved
from cutis.textures.atomic import check_writable, replacing, sweep
from cutis.textures.channels import ChannelFile, channel_writer, read_channels, write_channels
from cutis.textures.frame import Frame
from cutis.textures.labels import LabelFile
from cutis.textures.mask import MaskFile, read_mask
from cutis.textures.reading import TextureFile, read_texture
from cutis.textures.spaces import colour_space
from cutis.textures.texture import Texture, bands
from cutis.textures.turning import Orientation
from cutis.textures.writing import format_of, texture_writer, write_texture

__all__ = [
    "ChannelFile",
    "Frame",
    "LabelFile",
    "MaskFile",
    "Orientation",
    "Texture",
    "TextureFile",
    "bands",
    "channel_writer",
    "check_writable",
    "colour_space",
    "format_of",
    "read_channels",
    "read_mask",
    "read_texture",
    "replacing",
    "sweep",
    "texture_writer",
    "write_channels",
    "write_texture",
]

_MOVED = {
    "SpectralCube": "cutis.spectra:SpectralCube",
    "open_cube": "cutis.spectra:open_cube",
    "write_clf": "cutis.luts:write_clf",
    "write_cube": "cutis.luts:write_cube",
}


def __getattr__(name: str) -> Any:
    return moved(__name__, name, _MOVED)
