"""Parameters → albedo: the albedo space, its spectral table, sampling."""

from cutis.albedo.sampling import halton, uniform
from cutis.albedo.space import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import SpectralTable, build, spectral_table

__all__ = [
    "AlbedoSpace",
    "SpectralTable",
    "albedo_space",
    "build",
    "halton",
    "spectral_table",
    "uniform",
]
