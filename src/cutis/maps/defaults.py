"""What users get who name no model and no tissue: one constant for the whole house."""

from cutis.inverse.model import Model
from cutis.inverse.registry import load_model as by_name
from cutis.optics import Tissue

DEFAULT = "measured2026"
"""The model that is used when none is named; headers and reports say this name, never `default`."""
OLD_DEFAULT = "aliaga2022-exact"
"""What files of maps mean that say `default`: they are from before there was another one."""


def load_model(model: Model | str | None = None, device: str = "cpu") -> Model:
    """The model called `model`, DEFAULT for None or "default"; a `Model` is itself.

    See `inverse.load_model` for names, devices and errors.
    """
    if isinstance(model, Model):
        return model
    return by_name(DEFAULT if model in (None, "default") else str(model), device)


def default_tissue() -> Tissue:
    """The tissue of the model that is used when none is named."""
    return load_model().tissue
