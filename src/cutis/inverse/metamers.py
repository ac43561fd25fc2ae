"""Metamers: the skins that share a colour under D65, and how they part under other lights.

Five parameters for three numbers: behind a colour stands a whole family of skins. Nothing in an RGB
albedo tells its members apart; another light does, a little.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace
from cutis.colour import delta_e, reflectance_to_rgb
from cutis.errors import CutisError
from cutis.optics import PARAMETERS, WAVELENGTHS, from_coordinates

SCOUTS = 1 << 20
"""Skins of the first, coarse search."""
WIDER = 6.0
"""How many times the tolerance the first search allows."""
MARGIN = 0.1
"""By what share of its size the box that it found is widened on every side."""
ROUND = 1 << 18
"""Skins tried between two looks at how many were found."""


@dataclass(frozen=True)
class Family:
    """(n, 5) skins, evenly spread in network coordinates over all that look like `colour`.

    `colour` (3,) linear sRGB under D65; `share` is the part of the albedo space, by its volume in
    network coordinates, that the family fills.
    """

    skins: NDArray[np.floating]
    colour: NDArray[np.float64]
    share: float


def metamers(
    colour: ArrayLike,
    tolerance: float = 1.0,
    count: int = 1000,
    *,
    space: AlbedoSpace,
    seed: int = 0,
    most: int = 1 << 25,
) -> Family:
    """The family of skins within `tolerance` ΔE00 of `colour` (3,), linear sRGB under D65.

    Skins are drawn evenly from a box in network coordinates, found by a coarse search, and kept
    if they fit, until there are `count` or `most` were tried. Raises CutisError when the colour is
    not three finite numbers or no skin has it.
    """
    target = np.asarray(colour, dtype=np.float64)
    if target.shape != (3,) or not np.isfinite(target).all():
        raise CutisError("a colour must be three finite numbers, linear sRGB")
    if not (tolerance > 0 and count > 0):
        raise CutisError("tolerance and count of metamers must be above zero")
    if space.tissue.parameters != PARAMETERS:
        raise CutisError(
            f"metamers are of tissues with the five free parameters, not {space.tissue.name}"
        )
    rng = np.random.default_rng(seed)
    scouts = rng.random((SCOUTS, 5))
    near = scouts[_distance(space, scouts, target) < WIDER * tolerance]
    if not len(near):
        raise CutisError("no skin has that colour within the tolerance; is it in the gamut?")
    size = near.max(axis=0) - near.min(axis=0)
    low = np.maximum(near.min(axis=0) - MARGIN * size, 0.0)
    high = np.minimum(near.max(axis=0) + MARGIN * size, 1.0)
    kept: list[NDArray[np.float64]] = []
    found = tried = 0
    while found < count and tried < most:
        tries = low + (high - low) * rng.random((ROUND, 5))
        members = tries[_distance(space, tries, target) < tolerance]
        kept.append(members)
        found, tried = found + len(members), tried + ROUND
    if not found:
        raise CutisError("no skin has that colour within the tolerance; is it in the gamut?")
    share = found / tried * float(np.prod(high - low))
    return Family(from_coordinates(np.concatenate(kept)[:count]), target, share)


def colours_under(
    skins: ArrayLike, lights: Sequence[str], space: AlbedoSpace
) -> dict[str, NDArray[np.float64]]:
    """(n, 3) linear sRGB of (n, 5) skins under each light, white-balanced to it."""
    spectra = space.reflectance(skins)
    return {light: reflectance_to_rgb(spectra, WAVELENGTHS, light) for light in lights}


def spread(colours: ArrayLike) -> NDArray[np.float32]:
    """ΔE00 of each of (n, 3) colours from their mean → (n,)."""
    values = np.asarray(colours)
    return delta_e(values, np.broadcast_to(values.mean(axis=0), values.shape))


def _distance(
    space: AlbedoSpace, coordinates: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.float64]:
    """ΔE00 from the target where it can be small, infinite elsewhere; coordinates (n, 5) → (n,)."""
    rgb = space.rgb(from_coordinates(coordinates))
    # ΔE00 is slow; a colour whose RGB is far off in proportion cannot be near in it
    close = (np.abs(rgb - target) < 0.35 * target + 0.02).all(axis=1)
    result = np.full(len(rgb), np.inf)
    if close.any():
        result[close] = delta_e(rgb[close], np.broadcast_to(target, (int(close.sum()), 3)))
    return result
