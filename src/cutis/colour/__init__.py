"""Spectrum ↔ RGB: observers, illuminants, transfer function, colour differences."""

from cutis.colour.difference import delta_e, is_skin_colour, ita, lab
from cutis.colour.observer import illuminant
from cutis.colour.spectra import reflectance_to_rgb, spectrum_to_rgb, spectrum_to_xyz
from cutis.colour.transfer import decode_srgb, encode_srgb

__all__ = [
    "decode_srgb",
    "delta_e",
    "encode_srgb",
    "illuminant",
    "is_skin_colour",
    "ita",
    "lab",
    "reflectance_to_rgb",
    "spectrum_to_rgb",
    "spectrum_to_xyz",
]
