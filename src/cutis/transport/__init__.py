"""How light moves in skin: discrete ordinates, and a plain reference by doubling."""

from cutis.transport.discrete_ordinates import (
    Balance,
    Layer,
    stack_balance,
    two_layer_albedo,
)
from cutis.transport.fresnel import fresnel_reflectance

__all__ = ["Balance", "Layer", "fresnel_reflectance", "stack_balance", "two_layer_albedo"]
