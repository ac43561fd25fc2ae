"""Parameters and their coordinates, compiled; formulas and `axes` (5, p) are in `warp.py`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 1 << 14
"""Skins that a thread converts at a time."""
ZERO, ONE = np.float32(0), np.float32(1)


@compiled(fast=True, inline=True)
def raised(x: Any, root: Any) -> Any:
    """x to the power of a whole number from 1 to 4."""
    squared = x * x
    odd = x if root == 1 else squared * x
    return squared if root == 2 else squared * squared if root == 4 else odd


@compiled(fast=True, inline=True)
def rooted(x: Any, root: Any) -> Any:
    """The root of it."""
    if root == 1:
        return x
    if root == 3:
        return np.cbrt(x)
    return np.sqrt(x) if root == 2 else np.sqrt(np.sqrt(x))


@compiled(fast=True, inline=True)
def value_of(u: Any, axes: Any, p: Any) -> Any:
    """Parameter p at coordinate u, in its unit and range."""
    value = raised(axes[1, p] + min(max(u, ZERO), ONE) * axes[2, p], axes[0, p])
    return min(max(value, axes[3, p]), axes[4, p])


@compiled(fast=True, inline=True)
def slope_of(u: Any, axes: Any, p: Any) -> Any:
    """∂p/∂u at u."""
    root = axes[0, p]
    x = axes[1, p] + u * axes[2, p]
    squared = x * x
    outer = ONE if root == 1 else x if root == 2 else squared if root == 3 else squared * x
    return root * outer * axes[2, p]


@compiled(fast=True, inline=True)
def coordinate_of(value: Any, axes: Any, p: Any) -> Any:
    """Coordinate of a value of parameter p, not clamped."""
    return (rooted(value, axes[0, p]) - axes[1, p]) / axes[2, p]


@on_all_cores(PIECE, fast=True)
def _to_units(start: Any, stop: Any, coordinates: Any, axes: Any, out: Any) -> None:
    for p in range(out.shape[1]):
        for i in range(start, stop):
            out[i, p] = value_of(coordinates[i, p], axes, p)


@on_all_cores(PIECE, fast=True)
def _to_coordinates(start: Any, stop: Any, values: Any, axes: Any, out: Any) -> None:
    for p in range(out.shape[1]):
        for i in range(start, stop):
            out[i, p] = coordinate_of(values[i, p], axes, p)


def to_units(coordinates: NDArray[np.float32], axes: NDArray[np.float32]) -> NDArray[np.float32]:
    """(n, p) coordinates → (n, p) parameters, clamped to their ranges."""
    out = np.empty_like(coordinates)
    _to_units(len(out), coordinates, axes, out)
    return out


def to_coordinates(values: NDArray[np.float32], axes: NDArray[np.float32]) -> NDArray[np.float32]:
    """(n, p) parameters → (n, p) coordinates, not clamped."""
    out = np.empty_like(values)
    _to_coordinates(len(out), values, axes, out)
    return out
