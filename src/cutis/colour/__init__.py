"""Spectrum ↔ RGB: observers, illuminants, transfer function, colour differences."""

from cutis.colour.difference import delta_e, is_skin_colour, ita, lab
from cutis.colour.light import Light, light
from cutis.colour.observer import LightLike, illuminant
from cutis.colour.spaces import LINEAR, SPACES, SRGB, RGBSpace, Space, rgb_space
from cutis.colour.spectra import reflectance_to_rgb, spectrum_to_rgb, spectrum_to_xyz
from cutis.colour.transfer import decode_srgb, encode_srgb
from cutis.colour.upsampling import light_conversion, mallett_basis, upsample

__all__ = [
    "LINEAR",
    "SPACES",
    "SRGB",
    "Light",
    "LightLike",
    "RGBSpace",
    "Space",
    "decode_srgb",
    "delta_e",
    "encode_srgb",
    "illuminant",
    "is_skin_colour",
    "ita",
    "lab",
    "light",
    "light_conversion",
    "mallett_basis",
    "reflectance_to_rgb",
    "rgb_space",
    "spectrum_to_rgb",
    "spectrum_to_xyz",
    "upsample",
]
