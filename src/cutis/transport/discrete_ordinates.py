"""Exact transport in layered skin: discrete ordinates in admittance form.

Let l± be the radiance down and up in each direction times √(weight·μ), s = l⁺ + l⁻ and
d = l⁺ − l⁻. In a homogeneous layer (depth x, cm; coefficients in cm⁻¹)

    s' = −A d,   d' = −B s,   A = M^−½ (μt − μs (P − Q)) M^−½,   B = M^−½ (μt − μs (P + Q)) M^−½,

with M = diag(μ) and P, Q the kernels into the same and the opposite hemisphere, all symmetric.
With A = C Cᵀ, B = L Lᵀ and the singular values Lᵀ C = U diag(k) Vᵀ the layer falls apart into N
transmission lines σ' = −y, y' = −k² σ, where s = G σ, y = Gᵀ d, G = C V. Whatever lies below a
depth acts on what is above through one symmetric *admittance* Z there, d = Z s:

    half space      Zσ = diag(k)
    layer, depth t  Zσ = k coth kt − (k / sinh kt) (Zσ,below + k coth kt)^−1 (k / sinh kt)
    boundary        Z = diag((1 − F) / (1 + F)),  F the Fresnel reflectance (0 where n matches)

No exponential grows, k = 0 (no absorption) is a regular point, and energy is conserved to
rounding. The method is that of discrete ordinates [chandrasekhar1960]; the admittance form makes
it robust. A plain reference by doubling stands beside it in `doubling.py`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.transport.fresnel import fresnel_reflectance
from cutis.transport.phase import henyey_greenstein
from cutis.transport.quadrature import Directions, beam_cosine, directions

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Layer:
    """A homogeneous layer: μa, μs in cm⁻¹, g = ⟨cos θ⟩, depth in cm (inf: a half space)."""

    absorption: float
    scattering: float
    anisotropy: float = 0.0
    depth: float = np.inf


@dataclass(frozen=True)
class Balance:
    """Where light that has entered a stack of layers ends, as shares that sum to 1.

    `reflected` leaves through the top, `transmitted` through the bottom (0 for a half space),
    `absorbed` (L,) in each layer, computed from the radiance inside, not as a remainder.
    """

    reflected: float
    transmitted: float
    absorbed: Array


def _transposed(a: NDArray[np.floating]) -> Array:
    return np.swapaxes(a, -1, -2)


def _solve(a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.solve(a, b), dtype=np.float64)


def modes(
    nodes: Directions, absorption: ArrayLike, scattering: float, g: float
) -> tuple[Array, Array, Array]:
    """Rates k (..., N) in cm⁻¹, G and G^−T (..., N, N) for absorptions (...) in cm⁻¹."""
    given, least = np.asarray(absorption, dtype=np.float64), 1e-14 * scattering
    mu_a = np.maximum(given, least)[..., None, None]  # so that B has a Cholesky factor
    same, opposite = henyey_greenstein(nodes, g)
    unit, inverse = np.eye(len(nodes.cosine)), 1.0 / np.sqrt(nodes.cosine)
    metric = inverse[:, None] * inverse
    odd = ((mu_a + scattering) * unit - scattering * (same - opposite)) * metric
    even = ((mu_a + scattering) * unit - scattering * (same + opposite)) * metric
    chol = np.linalg.cholesky(odd)
    # k as singular values of Lᵀ C, B = L Lᵀ: an eigenvalue k² would lose half the digits of small k
    _, k, rows = np.linalg.svd(_transposed(np.linalg.cholesky(even)) @ chol)
    k[..., -1] = np.where(given < least, 0.0, k[..., -1])  # uniform radiance does not decay then
    vectors = _transposed(rows)
    return k, chol @ vectors, _solve(_transposed(chol), vectors)


def _half_space(k: Array, dual: Array) -> Array:
    """Admittance (..., N, N) of a half space: G^−T diag(k) G^−1."""
    return (dual * k[..., None, :]) @ _transposed(dual)


def _hyperbolic(k: Array, depth: ArrayLike) -> tuple[Array, Array]:
    """(k coth kt, k / sinh kt), both 1/t at k = 0, shape of k broadcast with depth (cm)."""
    t = np.asarray(depth, dtype=np.float64)
    x = k * t
    small = x < 1e-6
    safe = np.where(small, 1.0, x)
    shrink = np.exp(-safe)
    gap = -np.expm1(-2.0 * safe)
    coth = np.where(small, 1.0 + x * x / 3.0, safe * (1.0 + shrink * shrink) / gap)
    csch = np.where(small, 1.0 - x * x / 6.0, safe * 2.0 * shrink / gap)
    return coth / t, csch / t


def _cover(below: Array, k: Array, depth: float) -> tuple[Array, Array]:
    """A layer upon a Zσ (..., N, N): the Zσ above it, and σ at its bottom per σ at its top."""
    coth, csch = _hyperbolic(k, depth)
    unit = np.eye(len(k))
    if csch.max() < np.abs(below).max():
        through = _solve(below + coth * unit, csch * unit)
        return coth * unit - csch[:, None] * through, through
    # The same for a thin layer, where that is a difference of numbers as large as 1/t.
    half = k * np.tanh(0.5 * k * depth) * unit
    inside = below + half
    lost = _solve(inside + csch * unit, inside)
    return half + inside - inside @ lost, unit - lost


def stack_balance(
    layers: Sequence[Layer],
    *,
    dimension: int = 3,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    count: int = 48,
) -> Balance:
    """Fate of light that has just entered a stack of layers, the first on top.

    `incidence` is "lambertian" (a cosine lobe about the inward normal) or the cosine, *inside*,
    of a collimated beam. `refractive_index` is that of every layer, air (1) around; light meets
    the Fresnel boundary on its way out. To refer to light that falls on the surface from outside,
    multiply by its transmittance and add its reflectance (`fresnel_reflectance`).
    Only the last layer may be a half space. `count` nodes per hemisphere. Raises CutisError for
    layers that are not physical.
    """
    check_layers(layers)
    beam = beam_cosine(incidence)
    nodes = directions(count, dimension, refractive_index, beam)
    flux = nodes.flux
    fresnel = fresnel_reflectance(nodes.cosine, 1.0 / refractive_index)
    outside = (1.0 - fresnel) / (1.0 + fresnel)

    admittance = np.diag(outside)  # of what lies below the layer in hand
    down: list[tuple[Array, Array, Array, Array, Array]] = []  # k, G, G^−T, σ, y below per σ
    for layer in reversed(layers):
        k, g, dual = modes(nodes, layer.absorption, layer.scattering, layer.anisotropy)
        if np.isinf(layer.depth):
            admittance = _half_space(k, dual)
            down.append((k, g, dual, np.zeros_like(g), np.zeros_like(g)))
            continue
        below = g.T @ admittance @ g
        above, through = _cover(below, k, layer.depth)
        admittance = dual @ ((above + above.T) / 2) @ dual.T
        down.append((k, g, dual, through, below @ through))

    source = flux / (flux @ flux) if beam is None else np.eye(len(flux))[-1] / flux[-1]
    s = np.linalg.solve(np.diag(outside) + admittance, 2.0 * source / (1.0 + fresnel))
    up = (s - source) / (1.0 + fresnel)
    reflected = flux @ ((1.0 - fresnel) * up)

    absorbed = []
    d = admittance @ s
    for layer, (k, g, dual, through, flow) in zip(layers, reversed(down), strict=True):
        sigma, y = dual.T @ s, g.T @ d
        sigma_below, y_below = through @ sigma, flow @ sigma
        # absorbed = μa Σ √(w/μ) ∫ s dx, and k² ∫ σ dx = y − y_below from d' = −B s
        decaying = k > 0  # all, unless nothing absorbs
        column = g[:, decaying] @ ((y - y_below)[decaying] / k[decaying] ** 2)
        share = layer.absorption * (np.sqrt(nodes.weight / nodes.cosine) @ column)
        absorbed.append(share if decaying.all() else 0.0)
        s, d = g @ sigma_below, dual @ y_below
    transmitted = 0.0 if np.isinf(layers[-1].depth) else float(flux @ d)
    return Balance(float(reflected), transmitted, np.array(absorbed))


def two_layer_albedo(
    epidermis_absorption: ArrayLike,
    dermis_absorption: ArrayLike,
    thickness: ArrayLike,
    scattering: float,
    anisotropy: float,
    *,
    dimension: int = 2,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    count: int = 24,
    dermis_scattering: float | None = None,
) -> Array:
    """Albedo (E, D, T) of epidermis over a semi-infinite dermis for all combinations.

    `epidermis_absorption` (E,) and `dermis_absorption` (D,) in cm⁻¹, `thickness` (T,) of the
    epidermis in µm; one scattering coefficient (cm⁻¹) and anisotropy for both layers, as at one
    wavelength, unless `dermis_scattering` gives the dermis its own. Light starts inside, Lambertian
    or as a beam at cosine `incidence`; `refractive_index` 1 is the index-matched boundary. Same
    method as `stack_balance`, batched.
    Raises CutisError for coefficients that are not physical.
    """
    epidermis, dermis, microns = (
        np.atleast_1d(np.asarray(values, dtype=np.float64))
        for values in (epidermis_absorption, dermis_absorption, thickness)
    )
    _check_two_layers(epidermis, dermis, microns, scattering, anisotropy)
    beam = beam_cosine(incidence)
    nodes = directions(count, dimension, refractive_index, beam)
    flux = nodes.flux
    fresnel = fresnel_reflectance(nodes.cosine, 1.0 / refractive_index)
    source = flux / (flux @ flux) if beam is None else np.eye(len(flux))[-1] / flux[-1]

    below_scattering = scattering if dermis_scattering is None else dermis_scattering
    _check_two_layers(epidermis, dermis, microns, below_scattering, anisotropy)
    k, _, dual = modes(nodes, dermis, below_scattering, anisotropy)
    below = _half_space(k, dual)
    rates, mixing, _ = modes(nodes, epidermis, scattering, anisotropy)
    result = np.empty((len(rates), len(below), len(microns)))
    for e, (k, g) in enumerate(zip(rates, mixing, strict=True)):
        seen = g.T @ below @ g  # (D, N, N), the dermis in the modes of the epidermis
        boundary = (g.T * ((1.0 - fresnel) / (1.0 + fresnel))) @ g
        drive = g.T @ (2.0 * source / (1.0 + fresnel))
        for i, depth in enumerate(microns * 1e-4):
            whole = boundary + _cover(seen, k, depth)[0]
            s = np.linalg.solve(whole, np.broadcast_to(drive[:, None], (*whole.shape[:-1], 1)))
            up = (g @ s)[..., 0] - source
            result[e, :, i] = up @ (flux * (1.0 - fresnel) / (1.0 + fresnel))
    return result


def half_space_albedo(
    absorption: ArrayLike,
    scattering: float,
    anisotropy: float,
    *,
    dimension: int = 3,
    refractive_index: float = 1.0,
    incidence: float | str = "lambertian",
    count: int = 48,
) -> Array:
    """Albedo (n,) of homogeneous half spaces of `absorption` (n,) in cm⁻¹, else alike.

    As `stack_balance` of one infinite layer, batched. Raises CutisError for coefficients that are
    not physical.
    """
    given = np.atleast_1d(np.asarray(absorption, dtype=np.float64))
    _check_two_layers(given, given, np.ones(1), scattering, anisotropy)
    beam = beam_cosine(incidence)
    nodes = directions(count, dimension, refractive_index, beam)
    flux = nodes.flux
    fresnel = fresnel_reflectance(nodes.cosine, 1.0 / refractive_index)
    source = flux / (flux @ flux) if beam is None else np.eye(len(flux))[-1] / flux[-1]
    k, _, dual = modes(nodes, given, scattering, anisotropy)
    whole = _half_space(k, dual) + np.diag((1.0 - fresnel) / (1.0 + fresnel))
    drive = np.broadcast_to((2.0 * source / (1.0 + fresnel))[:, None], (*whole.shape[:-1], 1))
    up = np.linalg.solve(whole, drive)[..., 0] - source
    return np.asarray(up @ (flux * (1.0 - fresnel) / (1.0 + fresnel)))


def check_layers(layers: Sequence[Layer]) -> None:
    """Raises CutisError when a layer is not physical or a half space lies above another layer."""
    for number, layer in enumerate(layers, 1):
        values = (layer.absorption, layer.scattering, layer.anisotropy)
        if not np.all(np.isfinite(values)) or min(values[:2]) < 0 or not sum(values[:2]) > 0:
            raise CutisError(
                f"layer {number}: absorption and scattering must be finite, not negative and "
                "not both zero"
            )
        if not -1 < layer.anisotropy < 1:
            raise CutisError(f"layer {number}: anisotropy must lie inside (-1, 1)")
        if not layer.depth > 0 or (np.isinf(layer.depth) and number < len(layers)):
            raise CutisError(f"layer {number}: depth must be positive, infinite in the last only")
    if not layers:
        raise CutisError("a stack needs at least one layer")


def _check_two_layers(
    epidermis: Array, dermis: Array, thickness: Array, scattering: float, anisotropy: float
) -> None:
    """The same for `two_layer_albedo`; absorptions and thicknesses are (n,)."""
    if not (np.isfinite(scattering) and scattering >= 0):
        raise CutisError(f"scattering = {scattering}: it must be finite and not negative")
    if not -1 < anisotropy < 1:
        raise CutisError(f"anisotropy = {anisotropy}: it must lie inside (-1, 1)")
    for name, values in (("epidermis", epidermis), ("dermis", dermis)):
        if values.ndim != 1 or not np.all(np.isfinite(values)) or np.any(values < 0):
            raise CutisError(f"{name}_absorption must be a list of finite numbers, none negative")
        if scattering == 0 and np.any(values == 0):
            raise CutisError(f"{name}_absorption and scattering must not both be zero")
    if thickness.ndim != 1 or not np.all(np.isfinite(thickness)) or np.any(thickness <= 0):
        raise CutisError("thickness must be a list of finite numbers of µm, all above zero")
