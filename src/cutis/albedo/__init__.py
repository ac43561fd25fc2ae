"""Parameters → albedo: the albedo space, its spectral table, sampling, Monte Carlo simulation."""

from cutis.albedo.sampling import halton, uniform
from cutis.albedo.simulation import (
    SkinSimulation,
    TensorSimulation,
    Walks,
    grid_skins,
)
from cutis.albedo.space import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import SpectralTable, build, spectral_table

__all__ = [
    "AlbedoSpace",
    "SkinSimulation",
    "SpectralTable",
    "TensorSimulation",
    "Walks",
    "albedo_space",
    "build",
    "grid_skins",
    "halton",
    "spectral_table",
    "uniform",
]
