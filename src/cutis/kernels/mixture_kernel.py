"""Mixtures of substances, compiled; `recipe` (c, p) and `pure` (1 + c, n) are in `mixture.py`."""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled

ONE = np.float32(1)


@compiled(fast=True)
def shares(x: Any, recipe: Any, h: Any) -> None:
    """Fills h (c, n) with what skins x (p, n) hold of each substance."""
    for c in range(recipe.shape[0]):
        for i in range(h.shape[1]):
            h[c, i] = ONE
        for p in range(recipe.shape[1]):
            if recipe[c, p] == 1:
                for i in range(h.shape[1]):
                    h[c, i] *= x[p, i]
            elif recipe[c, p] == 2:
                for i in range(h.shape[1]):
                    h[c, i] *= ONE - x[p, i]


@compiled(fast=True)
def share_slopes(x: Any, recipe: Any, slopes: Any) -> None:
    """Fills slopes (c, p) with ∂h/∂x of one skin x (p,)."""
    for c in range(recipe.shape[0]):
        for p in range(recipe.shape[1]):
            slope = np.float32(0)
            if recipe[c, p] != 0:
                slope = ONE if recipe[c, p] == 1 else -ONE
                for q in range(recipe.shape[1]):
                    if q != p and recipe[c, q] != 0:
                        slope *= x[q] if recipe[c, q] == 1 else ONE - x[q]
            slopes[c, p] = slope


@compiled(fast=True)
def absorb_in_band(h: Any, pure: Any, b: Any, out: Any) -> None:
    """Fills out (n,) with μa in band b of n skins that hold h (c, n)."""
    for i in range(out.shape[0]):
        out[i] = pure[0, b]
    for c in range(pure.shape[0] - 1):
        each = pure[1 + c, b]
        for i in range(out.shape[0]):
            out[i] += h[c, i] * each


@compiled(fast=True)
def absorb_in_bands(h: Any, pure: Any, out: Any) -> None:
    """Fills out (n,) with μa in all n bands of one skin that holds h (c, 1)."""
    for b in range(out.shape[0]):
        out[b] = pure[0, b]
    for c in range(pure.shape[0] - 1):
        for b in range(out.shape[0]):
            out[b] += h[c, 0] * pure[1 + c, b]
