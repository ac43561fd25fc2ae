"""How light moves in skin: discrete ordinates, and a plain reference by doubling."""

from cutis.transport.discrete_ordinates import (
    Balance,
    Layer,
    stack_balance,
    two_layer_albedo,
)
from cutis.transport.doubling import adding_doubling
from cutis.transport.fresnel import fresnel_reflectance

__all__ = [
    "Balance",
    "Layer",
    "adding_doubling",
    "fresnel_reflectance",
    "stack_balance",
    "two_layer_albedo",
]
