"""Albedo → parameters: fit, networks, baked inverse, calibration of captures."""

from cutis.inverse.calibration import Calibration, calibrate
from cutis.inverse.fit import explain, fit
from cutis.inverse.metamers import Family, colours_under, metamers, spread
from cutis.inverse.model import Found, Model, ModelSurvey, Survey
from cutis.inverse.registry import MODELS, load_model, model_names, register
from cutis.inverse.spectral_fit import SpectralFit, SpectralFitter, fit_spectra

__all__ = [
    "MODELS",
    "Calibration",
    "Family",
    "Found",
    "Model",
    "ModelSurvey",
    "SpectralFit",
    "SpectralFitter",
    "Survey",
    "calibrate",
    "colours_under",
    "explain",
    "fit",
    "fit_spectra",
    "load_model",
    "metamers",
    "model_names",
    "register",
    "spread",
]
