"""The coordinate u ∈ [0, 1] of a parameter p, in plain NumPy: u = (p^(1/k) − a) / s.

a = low^(1/k) and s = high^(1/k) − a for a parameter from `low` to `high` with the root k, a small
whole number. Kernels take the numbers of several parameters as an array of `axes`
(`warp_kernel.py`).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

ROOT, START, SPAN, LOW, HIGH = range(5)
"""Rows of `axes`."""


def ends(low: float, high: float, root: int) -> tuple[float, float]:
    """a and s."""
    start = low ** (1 / root)
    return start, high ** (1 / root) - start


def to_coordinate(value: ArrayLike, low: float, high: float, root: int) -> NDArray[np.floating]:
    """p → u, any shape, not clamped."""
    start, span = ends(low, high, root)
    return (np.asarray(value) ** (1 / root) - start) / span


def from_coordinate(
    coordinate: ArrayLike, low: float, high: float, root: int
) -> NDArray[np.floating]:
    """u → p, any shape, clamped to the range."""
    start, span = ends(low, high, root)
    u = np.clip(coordinate, 0, 1)  # before an even power, which would hide a negative root
    return np.clip((start + u * span) ** root, low, high)


def slope(coordinate: ArrayLike, low: float, high: float, root: int) -> NDArray[np.floating]:
    """∂p/∂u at u, any shape."""
    start, span = ends(low, high, root)
    return root * (start + np.asarray(coordinate) * span) ** (root - 1) * span


def axes(low: Sequence[float], high: Sequence[float], root: Sequence[int]) -> NDArray[np.float64]:
    """(5, p) k, a, s, low and high of several parameters.

    One whose `low` is its `high` has no span: it stays there, whatever its coordinate.
    """
    each = [ends(*one) for one in zip(low, high, root, strict=True)]
    return np.array([root, *zip(*each, strict=True), low, high], dtype=np.float64)
