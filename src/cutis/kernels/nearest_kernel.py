"""Compiled search for the nearest of many colours (see `nearest.py`).

A balanced binary tree over points sorted into its leaves: node i has the children 2i + 1 and
2i + 2, and a box around its points. Boxes are searched nearest first and left out when they are
farther than the best point so far. Each query starts from the answer of the one before it, so
queries should come in an order in which neighbours are alike.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores

PIECE = 4096
"""Queries that a thread works on at a time, in order."""
SLACK = 1.0 + 1e-12
"""Rounding of squared distances, so that no box with an equally near point is left out."""


@compiled(inline=True)
def _box_distance(x: Any, y: Any, z: Any, low: Any, high: Any, node: Any) -> Any:
    """Squared distance from a point to the box of a node, 0 inside."""
    dx = max(low[node, 0] - x, x - high[node, 0], 0.0)
    dy = max(low[node, 1] - y, y - high[node, 1], 0.0)
    dz = max(low[node, 2] - z, z - high[node, 2], 0.0)
    return dx * dx + dy * dy + dz * dz


@compiled(inline=True)
def _distance(x: Any, y: Any, z: Any, points: Any, i: Any) -> Any:
    dx, dy, dz = x - points[i, 0], y - points[i, 1], z - points[i, 2]
    return dx * dx + dy * dy + dz * dz


@on_all_cores(PIECE)
def nearest_kernel(
    start: Any,
    stop: Any,
    queries: Any,
    order: Any,
    points: Any,
    index: Any,
    low: Any,
    high: Any,
    starts: Any,
    out: Any,
) -> None:
    """Fills out (n,) with the index of the point nearest to each query (n, 3), lowest of equals.

    `points` (m, 3) float64 in the order of the leaves, `index` (m,) what each was called before;
    `low`, `high` (nodes, 3) boxes; `starts` (leaves + 1,) where each leaf's points begin; `order`
    (n,) the order of the queries.
    """
    leaves = len(starts) - 1
    nodes, distances = np.empty(64, np.int64), np.empty(64)
    best = 0
    for k in range(start, stop):
        query = order[k]
        x, y, z = (
            np.float64(queries[query, 0]),
            np.float64(queries[query, 1]),
            np.float64(queries[query, 2]),
        )
        bound = _distance(x, y, z, points, best)
        nodes[0], distances[0], depth = 0, _box_distance(x, y, z, low, high, 0), 1
        while depth > 0:
            depth -= 1
            node = nodes[depth]
            if distances[depth] > bound * SLACK:
                continue
            if node >= leaves - 1:
                leaf = node - (leaves - 1)
                for i in range(starts[leaf], starts[leaf + 1]):
                    d = _distance(x, y, z, points, i)
                    if d < bound or (d == bound and index[i] < index[best]):
                        bound, best = d, i
                continue
            left, right = 2 * node + 1, 2 * node + 2
            to_left = _box_distance(x, y, z, low, high, left)
            to_right = _box_distance(x, y, z, low, high, right)
            if to_left > to_right:
                left, right, to_left, to_right = right, left, to_right, to_left
            if to_right <= bound * SLACK:
                nodes[depth], distances[depth] = right, to_right
                depth += 1
            if to_left <= bound * SLACK:
                nodes[depth], distances[depth] = left, to_left
                depth += 1
        out[query] = index[best]
