"""The nearest of many colours, exactly, for many colours at once.

A balanced tree over tight boxes, searched in double precision; queries go along a Morton curve and
each starts from the answer of the one before, which closes most boxes at once, also far from the
points (docs/decisions/0007). The answer is that of brute force, of equals the lowest index.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError

LEAF = 8
"""Most points in a leaf of the search tree."""
CURVE_CELLS = 128
"""Cells per axis of the curve along which queries are sorted."""


def finite_colours(colours: ArrayLike) -> NDArray[np.float32]:
    """(n, 3) linear sRGB as float32; CutisError for other shapes and colours not finite."""
    with np.errstate(over="ignore"):  # what float32 cannot hold is refused below
        queries = np.ascontiguousarray(colours, dtype=np.float32)
    if queries.ndim != 2 or queries.shape[1] != 3:
        raise CutisError(f"colours must be (n, 3) linear sRGB, not {queries.shape}")
    if not np.isfinite(queries).all():
        raise CutisError("some colours are NaN or infinite; mask them out")
    return queries


class NearestColour:
    """Search among (m, 3) points, float32."""

    def __init__(self, points: NDArray[np.float32]) -> None:
        """Builds the tree, half a second for 256 000 points."""
        self._tree = _search_tree(points)

    def __call__(self, colours: NDArray[np.float32]) -> NDArray[np.int64]:
        """(n, 3) finite colours → (n,) index of the nearest point."""
        from cutis.kernels.nearest_kernel import nearest_kernel

        points, index, low, high, starts = self._tree
        out = np.empty(len(colours), dtype=np.int64)
        order = curve_order(colours)
        nearest_kernel(len(order), colours, order, points, index, low, high, starts, out)
        return out


def _search_tree(points: NDArray[np.float32]) -> tuple[NDArray[np.generic], ...]:
    """(points in order of leaves, their index, box ends low and high, starts of leaves)."""
    levels = max(int(np.ceil(np.log2(max(len(points) / LEAF, 1)))), 0)
    order = np.arange(len(points))
    segments = [(0, len(points))]
    low, high = np.empty((2, 2 ** (levels + 1) - 1, 3))
    node = 0
    for level in range(levels + 1):
        parts = []
        for start, stop in segments:
            inside = points[order[start:stop]]
            low[node], high[node] = inside.min(axis=0), inside.max(axis=0)
            if level < levels:
                axis = int(np.argmax(high[node] - low[node]))
                middle = (stop - start) // 2
                split = np.argpartition(inside[:, axis], middle)
                order[start:stop] = order[start:stop][split]
                parts += [(start, start + middle), (start + middle, stop)]
            node += 1
        if level < levels:
            segments = parts
    starts = np.array([start for start, _ in segments] + [len(points)])
    return points[order].astype(np.float64), order, low, high, starts


def curve_order(colours: NDArray[np.float32]) -> NDArray[np.int64]:
    """(n,) order of (n, 3) colours along a Morton curve through their bounding box."""
    if not len(colours):
        return np.empty(0, dtype=np.int64)
    low = colours.min(axis=0).astype(np.float64)  # the box may be wider than float32 can say
    size = np.maximum(colours.max(axis=0) - low, 1e-30)
    cell = np.minimum((colours - low) / size * CURVE_CELLS, CURVE_CELLS - 1).astype(np.uint32)
    key = np.zeros(len(colours), dtype=np.uint32)
    for bit in range(CURVE_CELLS.bit_length() - 1):
        for axis in range(3):
            key |= ((cell[:, axis] >> np.uint32(bit)) & np.uint32(1)) << np.uint32(3 * bit + axis)
    return np.argsort(key, kind="stable")
