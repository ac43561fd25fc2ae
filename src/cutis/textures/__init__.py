"""Image files: textures as stored, masks and named channels, read and written without surprises."""

from cutis.textures.atomic import replacing
from cutis.textures.channels import read_channels, write_channels
from cutis.textures.mask import read_mask
from cutis.textures.reading import read_texture
from cutis.textures.texture import Encoding, Texture, out_of_range
from cutis.textures.writing import format_of, write_texture

__all__ = [
    "Encoding",
    "Texture",
    "format_of",
    "out_of_range",
    "read_channels",
    "read_mask",
    "read_texture",
    "replacing",
    "write_channels",
    "write_texture",
]
