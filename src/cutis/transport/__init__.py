"""How light moves in skin: discrete ordinates, a plain reference by doubling, Monte Carlo."""

from cutis.transport.discrete_ordinates import (
    Balance,
    Layer,
    half_space_albedo,
    stack_balance,
    two_layer_albedo,
)
from cutis.transport.doubling import adding_doubling
from cutis.transport.fresnel import fresnel_reflectance
from cutis.transport.monte_carlo import Walk, walk, walk_absorptions, walk_stacks

__all__ = [
    "Balance",
    "Layer",
    "Walk",
    "adding_doubling",
    "fresnel_reflectance",
    "half_space_albedo",
    "stack_balance",
    "two_layer_albedo",
    "walk",
    "walk_absorptions",
    "walk_stacks",
]
