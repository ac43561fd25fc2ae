"""Nodes of a LUT such that tetrahedra between them follow a function, by least squares.

OpenImageIO and most renderers read a LUT tetrahedrally: a cell is cut into six tetrahedra along its
grey diagonal, and a value is the mean of four nodes. That mean is linear in the nodes, so
the nodes that are best at many places in every cell solve a sparse system.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cutis.arrays import Floats, Where

SAMPLES = 12
"""Places in a cell at which the function is looked at."""
STAY = 0.02
"""Pull of a node towards where it was, against that of the samples around a typical one."""


def tetrahedral(places: Floats, size: int) -> tuple[NDArray[np.int64], Floats]:
    """(n, 3) places of 0 to 1 → the four nodes (n, 4), blue fastest, and their weights (n, 4)."""
    scaled = places * (size - 1)
    corner = np.clip(scaled.astype(np.int64), 0, size - 2)
    part = scaled - corner
    order = np.argsort(-part, axis=1, kind="stable")  # the channel that is furthest goes first
    falling = np.take_along_axis(part, order, axis=1)
    weights = np.stack(
        [
            1 - falling[:, 0],
            falling[:, 0] - falling[:, 1],
            falling[:, 1] - falling[:, 2],
            falling[:, 2],
        ],
        axis=1,
    )
    strides = np.array([size * size, size, 1])
    first = (corner @ strides)[:, None]
    return np.hstack([first, first + np.cumsum(strides[order], axis=1)]), weights


def refit(
    table: Floats,
    moved: Where,
    function: Callable[[Floats], Floats],
    weight: Callable[[Floats], Floats] | None = None,
) -> Floats:
    """The table (n, n, n, 3) with nodes of cells that have a `moved` (n, n, n) corner fitted.

    `function` takes (k, 3) places of 0 to 1 to values (k, 3); `weight` says of values how much
    their errors count. Other nodes, and all further away, stay as they are.
    """
    from scipy.sparse import csr_matrix, diags
    from scipy.sparse.linalg import cg

    size = len(table)
    low, high = slice(None, -1), slice(1, None)
    corners = [moved[a, b, c] for a in (low, high) for b in (low, high) for c in (low, high)]
    cells = np.argwhere(np.all(corners, axis=0))
    if len(cells) == 0:
        return table
    jitter = np.random.default_rng(0).random((len(cells), SAMPLES, 3))
    places = ((cells[:, None] + jitter) / (size - 1)).reshape(-1, 3)
    wanted = function(places)
    nodes, shares = tetrahedral(places, size)
    used, columns = np.unique(nodes, return_inverse=True)
    rows = np.arange(0, nodes.size + 1, 4)
    mean = csr_matrix((shares.ravel(), columns.ravel(), rows), shape=(len(places), len(used)))
    result = table.reshape(-1, 3).copy()
    factors = np.ones_like(wanted) if weight is None else weight(wanted)
    for channel in range(3):
        weighed = diags(factors[:, channel]) @ mean
        start = result[used, channel]
        missing = factors[:, channel] * wanted[:, channel] - weighed @ start
        normal = (weighed.T @ weighed).tocsr()
        strength = normal.diagonal()
        normal += diags(np.full(len(used), STAY * np.median(strength)))
        change, _ = cg(
            normal, weighed.T @ missing, rtol=1e-4, maxiter=60, M=diags(1 / normal.diagonal())
        )
        result[used, channel] = start + change
    return result.reshape(table.shape)
