"""The skin that best explains a colour: a small least-squares fit through the exact albedo space.

For each colour c the fit minimises

    |f(u) − c|² / s(c)² + (z − z₀)ᵀ P (z − z₀),   u = 1 / (1 + e^−z),

where f is the albedo space, z are unbounded logits of the network coordinates u, z₀ is what the
prior expects and s(c) the colour error that is worth one unit of prior: a fraction `tolerance` of
(c̄ + 0.01)^⅔, which is even in lightness.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace
from cutis.optics import NAMES


def logit(coordinates: ArrayLike) -> NDArray[np.float32]:
    """Coordinates u (any shape) → unbounded z; u is kept 1e-4 away from 0 and 1."""
    u = np.clip(np.asarray(coordinates, dtype=np.float32), 1e-4, 1 - 1e-4)
    return np.asarray(np.log(u / (1 - u)), dtype=np.float32)


def logistic(logits: ArrayLike) -> NDArray[np.float32]:
    """Unbounded z (any shape) → coordinates u ∈ (0, 1)."""
    return np.asarray(1 / (1 + np.exp(-np.asarray(logits, dtype=np.float32))), dtype=np.float32)


def fit(
    space: AlbedoSpace,
    colours: ArrayLike,
    centres: ArrayLike,
    precision: ArrayLike,
    tolerance: float,
    iterations: int = 30,
) -> NDArray[np.float32]:
    """(n, 3) linear sRGB → (n, p) coordinates u of the best skins.

    The p free parameters are those of the space's tissue, in their order: the five, unless it says
    otherwise. `centres` (n, p) or (p,) are the coordinates that the prior expects, `precision`
    (p, p) its P.
    """
    from cutis.inverse.fit_kernel import fit_kernel

    c = np.ascontiguousarray(colours, dtype=np.float32)
    every, free = space.every_parameter, list(space.places)
    given = np.broadcast_to(logit(centres), (len(c), len(free)))
    centre = np.zeros((len(c), len(every)), dtype=np.float32)
    centre[:, free] = given
    weight = 1 / (tolerance * (np.maximum(c.mean(axis=1), 0.0) + 0.01) ** (2 / 3))
    power = np.array([p.root for p in every], dtype=np.float32)
    low = np.array([p.low ** (1 / p.root) for p in every], dtype=np.float32)
    span = np.array([p.high ** (1 / p.root) for p in every], dtype=np.float32) - low
    for name, value in space.tissue.fixed:  # a range without extent: nothing moves there
        i = NAMES.index(name)
        low[i], span[i] = value ** (1 / every[i].root), 0.0
    prior = np.eye(len(every), dtype=np.float32)
    prior[np.ix_(free, free)] = precision
    out = np.empty_like(centre)
    fit_kernel(
        c,
        centre,
        weight.astype(np.float32),
        prior,
        iterations,
        low,
        span,
        power,
        space.model,
        out,
    )
    return logistic(out[:, free])
