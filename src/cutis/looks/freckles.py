"""Freckles: spots strewn by chance, the same at every resolution.

Spots are a Poisson process on the square of the texture's longer side, thinned by a smooth random
field, so that they cluster. Radii are log-normal, about a median. A spot of radius r is no circle:
its edge lies at r (1 + a cos 2θ + b cos 3θ), with a and b of its own.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.arrays import Map
from cutis.looks.masks import Cover
from cutis.looks.strokes import EDGE, THIN
from cutis.maps import Tile
from cutis.maps.patches import patches

SPREAD = 0.4
"""Standard deviation of the logarithm of radii."""
LARGEST = 2.5
"""Of radii, in medians; smaller than one of these parts of it there are none."""
PALEST = 0.4
"""Of the strengths of spots, which are even between it and 1."""
LOBES = np.array([0.15, 0.15, 0.07, 0.07]) / np.sqrt(2)
"""Standard deviations of a and b above, each of two phases; larger than twice that they are not."""
CLUSTERS = (0.22, 0.4, 1.2)
"""Size, coverage and width of the edges of the field that thins spots out, as of patches."""
GRID = 256
"""Nodes of that field along the longer side."""


def freckles(
    shape: tuple[int, int], size: float, density: float, clustered: float, soft: float, seed: int
) -> Cover:
    """The mask of freckles on a texture (H, W); see `FrecklesPart` for the numbers."""
    longer = max(shape)
    rng = np.random.default_rng([seed, 1])
    area = np.pi * size**2 * np.exp(2 * SPREAD**2)
    count = rng.poisson(-np.log1p(-density) / area)
    x, y, dice = rng.random((3, count))
    radius = size * np.clip(np.exp(SPREAD * rng.standard_normal(count)), 1 / LARGEST, LARGEST)
    strength = PALEST + (1 - PALEST) * rng.random(count)
    lobes = LOBES[:, None] * np.clip(rng.standard_normal((4, count)), -2, 2)
    inside = (x < shape[1] / longer) & (y < shape[0] / longer)
    kept = inside & (dice < 1 - clustered * (1 - _field(x, y, shape, seed)))
    order = np.flatnonzero(kept)[np.argsort(y[kept], kind="stable")]
    spots = np.stack([x * longer, y * longer, radius * longer, strength, *lobes], 1)[order]
    thin = np.minimum(1, spots[:, 2] / THIN)
    spots[:, 3] *= thin**2
    spots[:, 2] /= thin
    return _Freckles(spots, soft)


def _field(
    x: NDArray[np.float64], y: NDArray[np.float64], shape: tuple[int, int], seed: int
) -> Map:
    """How many of the spots at places are kept, 0-1."""
    height, width = (max(1, round(GRID * side / max(shape))) for side in shape)
    field = patches((height, width), slice(None), seed, *CLUSTERS)
    rows, columns = ((at * GRID).astype(np.int64) for at in (y, x))
    return field[np.minimum(rows, height - 1), np.minimum(columns, width - 1)]


class _Freckles(Cover):
    """`spots` (n, 8), sorted by height: x, y, radius in texels, strength, lobes."""

    def __init__(self, spots: NDArray[np.float64], soft: float) -> None:
        self._spots, self._soft = spots, soft
        widest = spots[:, 2].max(initial=0) * (1 + 2 * LOBES.sum())
        self._reach = widest + EDGE

    def __call__(self, tile: Tile) -> Map:
        from cutis.looks.freckles_kernel import strew

        first = tile.maps.whole.first_row
        cover = np.zeros(tile.maps.shape, dtype=np.float32)
        strew(len(cover), first, self._spots, self._soft, EDGE, self._reach, cover)
        return cover
