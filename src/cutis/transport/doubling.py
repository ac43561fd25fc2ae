"""Transport by adding and doubling: the plain reference beside `discrete_ordinates.py`.

Nothing is shared with the fast form but the Fresnel formula: other nodes, another form of the
phase function, another normalisation, no eigenvalues. A slab is four matrices that act on
radiance. One so thin that exponentials do no harm is solved by a matrix exponential; two equal
slabs make one twice as thick; a half space is a slab doubled until its thickness no longer
matters [vandehulst1980, chapter 4].
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutis.transport.discrete_ordinates import Layer, check_layers
from cutis.transport.fresnel import fresnel_reflectance
from cutis.transport.quadrature import beam_cosine, check_medium

Array = NDArray[np.float64]


class Slab(NamedTuple):
    """What a slab does to radiance, each (N, N): seen from above and below, let down and up."""

    reflects_above: Array
    reflects_below: Array
    down: Array
    up: Array


def adding_doubling(
    layers: Sequence[Layer],
    *,
    dimension: int = 3,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    count: int = 64,
) -> tuple[float, float]:
    """Shares of light, just entered, that leave a stack through its top and through its bottom.

    Arguments, conventions and errors are those of `stack_balance`. By reciprocity the share of a
    beam that leaves is the radiance seen along it under a uniform sky; the beam is then a node of
    no weight, and a Lambertian start is an average over nodes. Doubling piles up rounding: a half
    space that absorbs nothing comes out 1e-5 short.
    """
    check_layers(layers)
    beam = beam_cosine(incidence)
    check_medium(count, dimension, refractive_index)
    theta, weight = _nodes(count, dimension, refractive_index, beam)
    mu, one, none = np.cos(theta), np.eye(len(theta)), np.zeros((len(theta), len(theta)))
    fresnel = fresnel_reflectance(mu, 1.0 / refractive_index)

    # Light that reaches a surface is counted there; F of it goes back, 1 − F leaves.
    stack = Slab(none, np.diag(fresnel), one, one)
    for layer in layers:
        stack = _add(stack, _slab(layer, theta, weight, dimension))
    stack = _add(stack, Slab(np.diag(fresnel), none, one, one))

    # Seen under a sky that is uniform outside, reflected above and let through from below.
    sky = 1.0 - fresnel
    seen = np.stack([stack.reflects_above @ sky, stack.up @ sky])
    share = seen[:, -1] if beam is not None else seen @ (weight * mu) / (weight @ mu)
    return float(share[0]), float(share[1])


def _nodes(
    count: int, dimension: int, refractive_index: float, beam: float | None
) -> tuple[Array, Array]:
    """Angles to the normal (N,) and their weights (N,).

    Gauss–Legendre in s, with θ = s² (3 − 2s) of the way between 0, the critical angle and π/2,
    so that nodes crowd where radiance has kinks.
    """
    s, ds = np.polynomial.legendre.leggauss(count if refractive_index <= 1 else count // 2)
    s, ds = (s + 1) / 2, ds / 2
    ends = [0.0, np.pi / 2]
    if refractive_index > 1:
        ends.insert(1, float(np.arcsin(1 / refractive_index)))
    theta = np.concatenate([a + (b - a) * s * s * (3 - 2 * s) for a, b in pairwise(ends)])
    weight = np.concatenate([(b - a) * 6 * s * (1 - s) * ds for a, b in pairwise(ends)])
    if dimension == 3:
        weight *= np.sin(theta)
    if beam is not None:
        theta, weight = np.append(theta, np.arccos(beam)), np.append(weight, 0.0)
    return theta, weight


def _phase(theta: Array, weight: Array, g: float, dimension: int) -> tuple[Array, Array]:
    """Henyey–Greenstein scattering (N, N) of radiance j into i, same and opposite hemisphere.

    By the addition theorem p = Σ gⁿ χn(θ) χn(θ'), with χn = √2 cos nθ in flatland (χ0 = 1) and
    √(2n+1) Pn(cos θ) in space; odd χn change sign in the mirror. Rows are scaled so that
    radiance that is the same everywhere stays so, as it must where nothing absorbs.
    """
    from scipy.special import eval_legendre

    n = np.arange(1 if g == 0 else 2 + int(np.log(1e-14) / np.log(abs(g))))[:, None]
    if dimension == 3:
        chi = np.sqrt(2 * n + 1) * eval_legendre(n, np.cos(theta))
    else:
        chi = np.where(n == 0, 1.0, np.sqrt(2.0)) * np.cos(n * theta)
    same, opposite = chi.T @ (g**n * chi), chi.T @ ((-g) ** n * chi)
    total = ((same + opposite) @ weight)[:, None]
    return same * weight / total, opposite * weight / total


def _slab(layer: Layer, theta: Array, weight: Array, dimension: int) -> Slab:
    """A layer without surfaces."""
    from scipy.linalg import expm

    size, cosine = len(theta), np.cos(theta)[:, None]
    extinction = layer.absorption + layer.scattering
    albedo = layer.scattering / extinction
    same, opposite = _phase(theta, weight, layer.anisotropy, dimension)
    # ±μ dI±/dτ = −I± + albedo (same I± + opposite I∓)
    fade = (np.eye(size) - albedo * same) / cosine
    turn = albedo * opposite / cosine
    slope = np.block([[-fade, turn], [-turn, fade]])

    depth = extinction * layer.depth  # optical
    halvings = 0 if np.isinf(depth) else max(0, int(np.ceil(np.log2(depth / cosine.min()))))
    thin = cosine.min() if np.isinf(depth) else depth / 2.0**halvings
    solved = expm(slope * thin)
    # I−(thin) = 0 when nothing comes from below, which gives I−(0) = reflect I+(0)
    reflect = -np.linalg.solve(solved[size:, size:], solved[size:, :size])
    let_through = solved[:size, :size] + solved[:size, size:] @ reflect
    slab = Slab(reflect, reflect, let_through, let_through)
    for _ in range(100 if np.isinf(depth) else halvings):
        slab = _add(slab, slab)
        if slab.down.max() < 1e-14:
            break
    if np.isinf(depth):
        none = np.zeros((size, size))
        return Slab(slab.reflects_above, none, none, none)
    return slab


def _add(a: Slab, b: Slab) -> Slab:
    """The slab a upon the slab b: light goes to and fro between them any number of times."""
    one = np.eye(len(a.down))
    downward = np.linalg.inv(one - a.reflects_below @ b.reflects_above)
    upward = np.linalg.inv(one - b.reflects_above @ a.reflects_below)
    return Slab(
        a.reflects_above + a.up @ upward @ b.reflects_above @ a.down,
        b.reflects_below + b.down @ downward @ a.reflects_below @ b.up,
        b.down @ downward @ a.down,
        a.up @ upward @ b.up,
    )
