"""Albedo → parameters: fit, networks, baked inverse, calibration of captures."""

from cutis.inverse.calibration import Calibration, calibrate
from cutis.inverse.fit import fit
from cutis.inverse.models import MODELS, Model, load_model

__all__ = ["MODELS", "Calibration", "Model", "calibrate", "fit", "load_model"]
