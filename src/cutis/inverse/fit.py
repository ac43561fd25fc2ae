"""The skin that best explains a colour: a small least-squares fit through the exact albedo space.

For each colour c the fit minimises

    |f(u) − c|² / s(c)² + (z − z₀)ᵀ P (z − z₀),   u = 1 / (1 + e^−z),

where f is the albedo space, z are unbounded logits of the network coordinates u, z₀ is what the
prior expects and s(c) the colour error that is worth one unit of prior: a fraction `tolerance` of
(c̄ + 0.01)^⅔, which is even in lightness.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.errors import CutisError
from cutis.optics import Tissue, axes

CENTRE, TOLERANCE = 0.4, 0.001
"""Prior of `explain`: where every coordinate is expected, and so loosely that colours decide."""
BAND = 1 << 18
"""Colours that `explain` fits at a time."""


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
    ranges = axes(every, dict(space.tissue.fixed)).astype(np.float32)
    prior = np.eye(len(every), dtype=np.float32)
    prior[np.ix_(free, free)] = precision
    out = np.empty_like(centre)
    fit_kernel(
        len(c), c, centre, weight.astype(np.float32), prior, iterations, ranges, space.model,
        space.rgb_weights, out,
    )  # fmt: skip
    return logistic(out[:, free])


def explain(
    rgb: ArrayLike,
    tissue: Tissue,
    *,
    centre: float = CENTRE,
    tolerance: float = TOLERANCE,
) -> tuple[dict[str, NDArray[np.float32]], NDArray[np.float32]]:
    """(..., 3) linear sRGB → map (...) of every free parameter of `tissue`, and their (..., 3) RGB.

    Any tissue by the same machinery, whatever its parameters, so that tissues can be compared;
    what users estimate with are the models (docs/models.md). Maps are in the units and under the
    names of `tissue.parameters`. 0.1 to 0.2 ms a colour on two cores. Of colours that no skin of
    the tissue has, a few per cent stop short of the nearest. Raises CutisError unless colours are
    finite and have three channels.
    """
    colours = np.asarray(rgb, dtype=np.float32)
    if colours.ndim == 0 or colours.shape[-1] != 3:
        raise CutisError(f"colours must be (..., 3) linear sRGB, not of shape {colours.shape}")
    if not np.isfinite(colours).all():
        raise CutisError("some colours are not finite numbers; mask them out first")
    space, count = albedo_space(tissue), len(tissue.parameters)
    flat = colours.reshape(-1, 3)
    skins, model = np.empty((len(flat), count), np.float32), np.empty_like(flat)
    for start in range(0, len(flat), BAND):
        band = slice(start, start + BAND)
        u = fit(space, flat[band], np.full(count, centre), np.eye(count), tolerance)
        for i, known in enumerate(tissue.parameters):
            skins[band, i] = known.from_coordinate(u[:, i])
        model[band] = space.rgb(skins[band])
    maps = skins.reshape(*colours.shape[:-1], count)
    names = [known.name for known in tissue.parameters]
    return {name: maps[..., i] for i, name in enumerate(names)}, model.reshape(colours.shape)
