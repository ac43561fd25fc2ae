"""What to feed Cycles so that its random walk returns the diffuse albedo asked for.

Cycles, 4.2 to 5.2, method *Random Walk (Skin)* of the Principled BSDF, does this with a base colour
c, a radius r, an anisotropy g and an index n, channel by channel:

* the single-scattering albedo is the fit of Wrenninge et al. at c (`wrenninge2017`);
* the reduced mean free path is r √(3 (1 − α′)), where α′ is the reduced albedo of a dipole whose
  diffuse reflectance is c, found by twelve bisections;
* below a single-scattering albedo of 0.2 it walks with 0.2 and scales the result; walks of more
  than 255 scattering events are dropped, 8 % of the light where nothing is absorbed;
* half of the light enters along a cosine lobe, half is refracted by facets of GGX at roughness 1
  about the view; the surface is index-matched on the way out.

So base colours are found by the exact solver with these habits (`walked_albedo`, `base_colour`),
and the dipole is undone (`radius`). Diffuse albedos above 0.91 are out of reach.
Light that enters refracted runs steeper where it is seen square on, shallower at the rim: the
albedo seen depends on the view by −10 to +30 % on the darkest skin. `facing` takes that back in
the material, as a factor 1 + k(cos) h(c) of the colour, a cubic and a table from the exact solver.

All this from Blender 4.4 on. 4.2 and 4.3 do not walk at all in channels whose radius is less than a
quarter of a pixel, but return c as a Lambertian surface does: up to a tenth too much on dark skin
seen from afar. Up to 4.5, light of second bounces is Lambertian too.

Other methods are no better: *Random Walk* refracts everything, at the roughness of the gloss, and
changed its fit and its radius in 5.2.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator
from scipy.special import erfc

from cutis.errors import CutisError
from cutis.render.inversion import SLACK, diffuse_albedo, from_table
from cutis.render.published_fits import wrenninge2017
from cutis.transport import half_space_albedo

Array = NDArray[np.float64]

METHOD = "random_walk_skin"
INDEX = 1.4
"""Subsurface index of refraction that Cycles is given."""
STEPS = 1 << 13
"""Equal steps of the root of diffuse albedo in the table of base colours."""
TABLED = 64
"""Steps of the correction for the view."""
DARKEST, BRIGHTEST = 0.003, 0.88
"""Diffuse albedos from and to which the correction for the view is solved for."""
BISECTIONS = 12
LEAST_ALPHA = 0.2
MOST_EVENTS = 255
ESCAPE = 4 / np.sqrt(3)
"""(1 − A) / √(1 − α) of an isotropic half space as α → 1 [vandehulst1980]."""


def base_colour(albedo: ArrayLike, anisotropy: float = 0.0) -> NDArray[np.floating]:
    """Base colour (...) for diffuse albedo (...), 0 to 1, and anisotropy 0 to 0.9.

    float32 stays float32. Albedos beyond what Cycles can return get the most that it can. Raises
    CutisError for values out of range, NaN among them.
    """
    given = np.asarray(albedo)
    if given.size and not (given.min() >= -SLACK and given.max() <= 1 + SLACK):
        raise CutisError("the diffuse albedo must lie in 0 to 1")
    check_anisotropy(anisotropy)
    root = np.sqrt(np.clip(given, 0, 1))
    found = from_table(_table(float(anisotropy)), root)
    return found.astype(np.float32) if given.dtype == np.float32 else found


def radius(colour: ArrayLike, reduced_mean_free_path: ArrayLike) -> NDArray[np.float32]:
    """Radius (...) that makes Cycles walk with a reduced mean free path (...), in its unit.

    `colour` (...) is the base colour. The reduced mean free path is that of an isotropic walk,
    whatever the anisotropy.
    """
    table = _dipole()
    place = np.rint(np.clip(colour, 0, 1) * np.float32(len(table) - 1)).astype(np.int32)
    return np.asarray(reduced_mean_free_path, dtype=np.float32) / table[place]


@lru_cache(maxsize=16)
def facing(anisotropy: float = 0.0) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Cubic k of the cosine of the view, from the constant upwards, and table h of the base colour.

    The colour c seen at that cosine is to be c (1 + k h); h is given at TABLED + 1 equal steps of
    √c from 0 to 1, because it bends sharply where Cycles begins to scale. Raises CutisError for
    anisotropies that Cycles cannot walk with.
    """
    check_anisotropy(anisotropy)
    cosines, root = np.linspace(0.1, 1, 19), np.linspace(0, 1, TABLED + 1)
    fine = np.linspace(0, 1, 16 * STEPS + 1) ** 2
    fitted = np.maximum.accumulate(wrenninge2017(fine, anisotropy))
    albedo = walked_albedo(np.minimum(np.interp(root**2, fine, fitted), 1), anisotropy)
    inner = (albedo > DARKEST) & (albedo < BRIGHTEST)
    alpha, seen = seen_albedo(cosines, anisotropy)
    wanted = np.stack([
        np.interp(np.interp(albedo[inner], *_increasing(row, alpha)), fitted, fine) for row in seen
    ]) / root[inner] ** 2 - 1  # fmt: skip
    # views count as often as they occur on a sphere, changes of dark colours by what they are
    weight = np.sqrt(cosines)
    left, values, _ = np.linalg.svd(weight[:, None] * wanted)
    k = np.polynomial.polynomial.polyfit(cosines, left[:, 0] * values[0] / weight, 3, w=weight)
    view = cosines * np.polynomial.polynomial.polyval(cosines, k)
    h = view @ wanted / (view @ np.polynomial.polynomial.polyval(cosines, k))
    # below the darkest like it; of white all is seen at every view
    table = np.interp(root, [*root[inner], 1.0], [*h, 0.0])
    largest = np.abs(table).max()
    return tuple(float(v) for v in largest * k), tuple(float(v) for v in table / largest)


def walked_albedo(alpha: ArrayLike, anisotropy: float = 0.0) -> Array:
    """Diffuse albedo (...) that Cycles' walk returns of light entering along a cosine lobe."""
    given = np.asarray(alpha, dtype=np.float64)
    share, lost = _habits(given, anisotropy)
    return share * (diffuse_albedo(np.maximum(given, LEAST_ALPHA), anisotropy) - lost)


def _habits(alpha: Array, anisotropy: float) -> tuple[Array, Array]:
    """What dark albedos are scaled by, and the light of walks that are dropped as too long.

    Of orders of scattering n → ∞ comes ESCAPE / (2 √π) n^(−3/2) α^n of the light, here summed. A
    walk of anisotropy g goes on isotropically, by similarity, after nine events.
    """
    walked = np.maximum(alpha, LEAST_ALPHA)
    similar = walked * (1 - anisotropy) / (1 - walked * anisotropy)
    rate = -np.log(np.maximum(similar, 1e-9))
    many = MOST_EVENTS + 0.5
    lost = ESCAPE * (
        np.exp(-many * rate) / np.sqrt(np.pi * many) - np.sqrt(rate) * erfc(np.sqrt(many * rate))
    )
    return np.minimum(alpha / LEAST_ALPHA, 1), lost


def seen_albedo(cosines: ArrayLike, anisotropy: float = 0.0) -> tuple[Array, Array]:
    """Single-scattering albedos (n,), increasing, and what of uniform light is seen of them.

    (m, n) for m views at `cosines` to the normal, with Cycles' way of entering.
    """
    s = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 65) / 65)
    alpha = (1 - s * s)[::-1]
    walked = np.maximum(alpha, LEAST_ALPHA)
    inside = np.concatenate([[0.01], np.linspace(0.04, 1, 24)])
    plane = np.stack([
        half_space_albedo((1 - walked) / walked, 1.0, anisotropy, incidence=float(mu))
        for mu in inside
    ])  # fmt: skip
    diffuse = diffuse_albedo(walked, anisotropy)
    found = []
    for cosine in np.atleast_1d(cosines):
        entering, weight = _refracted(float(cosine))
        below = np.clip(np.searchsorted(inside, entering) - 1, 0, len(inside) - 2)
        share = (entering - inside[below]) / (inside[below + 1] - inside[below])
        mixed = plane[below].T * (weight * (1 - share)) + plane[below + 1].T * (weight * share)
        found.append(0.5 * diffuse + 0.5 * mixed.sum(axis=-1))
    share, lost = _habits(alpha, anisotropy)
    return alpha, share * (np.stack(found) - lost)


def check_anisotropy(anisotropy: float) -> None:
    """Raises CutisError for anisotropies that Cycles cannot walk with."""
    if not 0 <= anisotropy <= 0.9:
        raise CutisError(f"anisotropy = {anisotropy:g}: Cycles is fed 0 to 0.9")


def _refracted(cosine: float) -> tuple[Array, Array]:
    """Cosines (n,) below the surface of light refracted by facets seen at `cosine`, and weights.

    Facets of GGX at roughness 1, in proportion to how visible they are [heitz2018].
    """
    x, w = np.polynomial.legendre.leggauss(24)
    height, of_height = 0.5 * (x + 1), 0.5 * w
    phi = 2 * np.pi * (np.arange(48) + 0.5) / 48
    across = np.sqrt(1 - height**2)[:, None] * np.cos(phi) * np.sqrt(1 - cosine**2)
    towards = across + height[:, None] * cosine
    weight = np.maximum(towards, 0) * of_height[:, None]
    bent = towards / INDEX - np.sqrt(1 - (1 - towards**2) / INDEX**2)
    below = cosine / INDEX - bent * height[:, None]
    return below.ravel(), weight.ravel() / weight.sum()


@lru_cache(maxsize=1)
def _dipole() -> NDArray[np.float32]:
    """What Cycles multiplies radii by, at 2¹⁶ equal steps of the base colour."""
    c = np.linspace(0, 1, 1 << 16, dtype=np.float32)
    inverse = 1 / INDEX
    fresnel = inverse * (0.710 - 1.440 * inverse) + 0.668 + 0.0636 * INDEX
    depth = np.float32(4 / 3 * (1 + fresnel) / (1 - fresnel))
    low, high, middle = np.zeros_like(c), np.ones_like(c), np.zeros_like(c)
    for _ in range(BISECTIONS):
        middle = np.float32(0.5) * (low + high)
        s = np.sqrt(np.float32(3) * (1 - middle))
        darker = np.float32(0.5) * middle * (1 + np.exp(-depth * s)) * np.exp(-s) < c
        low, high = np.where(darker, middle, low), np.where(darker, high, middle)
    reduced = np.where(c < 1e-4, 0, np.where(c >= 0.995, np.float32(0.999999), middle))
    return np.sqrt(np.float32(3) * (1 - reduced)).astype(np.float32)


def _increasing(x: Array, y: Array) -> tuple[Array, Array]:
    """x and y where x rises."""
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(x)) > 0])
    return x[rising], y[rising]


@lru_cache(maxsize=16)
def _table(anisotropy: float) -> Array:
    """Base colour at STEPS + 1 equal steps of the root of diffuse albedo."""
    fine = np.linspace(0, 1, 16 * STEPS + 1)
    fitted = np.maximum.accumulate(wrenninge2017(fine**2, anisotropy))
    s = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0, 1, 512))
    alpha = (1 - s * s)[::-1]
    albedo = np.maximum.accumulate(walked_albedo(alpha, anisotropy))
    # in the root of the albedo both ends are smooth
    wanted = PchipInterpolator(*_increasing(np.sqrt(albedo), alpha), extrapolate=False)(
        np.minimum(np.linspace(0, 1, STEPS + 1), np.sqrt(albedo[-1]))
    )
    table = np.interp(wanted, fitted, fine) ** 2
    table.flags.writeable = False
    return np.asarray(table)
