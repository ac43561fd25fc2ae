"""Albedo → parameters: fit, networks, baked inverse, calibration of captures."""

from cutis.inverse.calibration import Calibration, calibrate
from cutis.inverse.fit import explain, fit
from cutis.inverse.metamers import Family, colours_under, metamers, spread
from cutis.inverse.models import MODELS, Model, load_model, model_name, on_device, tissue_of
from cutis.inverse.spectral_fit import SpectralFit, SpectralFitter, fit_spectra

__all__ = [
    "MODELS",
    "Calibration",
    "Family",
    "Model",
    "SpectralFit",
    "SpectralFitter",
    "calibrate",
    "colours_under",
    "explain",
    "fit",
    "fit_spectra",
    "load_model",
    "metamers",
    "model_name",
    "on_device",
    "spread",
    "tissue_of",
]
