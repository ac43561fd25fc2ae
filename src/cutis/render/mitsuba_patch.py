"""A flat patch of the renderer's medium in Mitsuba 3, under the same light from everywhere.

What comes back is the diffuse albedo, by a path tracer that shares nothing with Cycles or cutis:
a check of the subsurface inversion. Needs the extra `cutis[mitsuba]`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError

THICK = 300.0
"""Half the side of the block, in mean free paths: light that goes through does not count."""
PIXELS = 16
"""Along a side of the film; each pixel is an estimate of its own."""


@dataclass(frozen=True)
class Measured:
    """Mean over pixels of three bands, (3,), and the standard error of it."""

    albedo: NDArray[np.float64]
    error: NDArray[np.float64]


def patch_albedo(
    single_scattering: ArrayLike,
    anisotropy: float = 0.0,
    refractive_index: float = 1.0,
    *,
    samples: int = 64,
    seed: int = 0,
) -> Measured:
    """Share of light from everywhere that a patch returns, for three single-scattering albedos.

    `single_scattering` (3,), 0 to 1. A meter above the patch counts light along all directions by
    their cosine. With a `refractive_index` above 1 the surface is a smooth dielectric, and what it
    reflects at once counts too. `samples` per pixel, PIXELS² pixels. Raises CutisError without
    Mitsuba.
    """
    try:
        import mitsuba as mi
    except ModuleNotFoundError:
        raise CutisError("Mitsuba is missing; pip install 'cutis[mitsuba]'") from None
    alpha = np.asarray(single_scattering, dtype=np.float64)
    if alpha.shape != (3,) or not ((alpha >= 0) & (alpha <= 1)).all():
        raise CutisError("three single-scattering albedos from 0 to 1 are needed")
    before = mi.variant()
    mi.set_variant("scalar_rgb")
    try:
        scene = mi.load_dict(_scene(mi, alpha, anisotropy, refractive_index))
        light = mi.render(scene, spp=samples, seed=mi.UInt32(seed))
        film = np.array(light, dtype=np.float64)[..., :3]
    finally:
        if before is not None:
            mi.set_variant(before)
    pixels = film.reshape(-1, 3) / np.pi  # irradiance of radiance 1 is π
    return Measured(pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels)))


def _scene(mi: Any, alpha: NDArray[np.float64], g: float, index: float) -> dict[str, Any]:
    """A block of medium with unit extinction, its top at z = 0, and a meter looking down at it."""
    move = mi.ScalarTransform4f
    skin = {"type": "null"} if index == 1 else {
        "type": "dielectric", "int_ior": index, "ext_ior": 1.0,
    }  # fmt: skip
    return {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": 4000},
        "light": {"type": "constant", "radiance": 1.0},
        "block": {
            "type": "cube",
            "to_world": move().translate([0, 0, -THICK]).scale(THICK),
            "surface": skin,
            "interior": {
                "type": "homogeneous",
                "sigma_t": 1.0,
                "albedo": {"type": "rgb", "value": [float(a) for a in alpha]},
                "phase": {"type": "hg", "g": float(g)},
            },
        },
        "meter": {
            "type": "rectangle",
            "to_world": move().translate([0, 0, 1.0]).rotate([1, 0, 0], 180),
            "surface": {"type": "null"},
            "sensor": {
                "type": "irradiancemeter",
                "film": {
                    "type": "hdrfilm", "width": PIXELS, "height": PIXELS,
                    "rfilter": {"type": "box"}, "pixel_format": "rgb",
                    "component_format": "float32",
                },
                "sampler": {"type": "independent"},
            },
        },
    }  # fmt: skip
