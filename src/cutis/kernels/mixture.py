"""Absorption of a layer: what its substances absorb, times how much of each it holds.

A skin is a row of p parameters. Of substance c a layer holds the share

    h_c = Π_q  x_q        where recipe[c, q] is TIMES,
               1 − x_q    where it is WITHOUT,

and the absorption is linear in shares: μa = pure[0] + Σ_c h_c · pure[c], a product of matrices. The
first row is the rest of the layer, which fills what nothing else does; the rows of substances that
take up room hold their absorption less that of the rest. Compiled: `mixture_kernel.py`.
"""

import numpy as np
from numpy.typing import NDArray

TIMES, WITHOUT = 1, 2
"""Entries of a recipe; 0 is a parameter that does not count."""
Array = NDArray[np.float64]


def shares(skins: Array, recipe: NDArray[np.int64]) -> Array:
    """Skins (..., p) and a recipe (c, p) → h (..., c)."""
    x = skins[..., None, :]
    return np.where(recipe == TIMES, x, np.where(recipe == WITHOUT, 1 - x, 1.0)).prod(axis=-1)


def absorption(skins: Array, recipe: NDArray[np.int64], pure: Array) -> Array:
    """Skins (..., p), a recipe (c, p) and spectra (1 + c, n) → μa (..., n)."""
    return np.asarray(pure[0] + shares(skins, recipe) @ pure[1:])
