"""One photon's history in a stack of layers, written once for every device.

`make_history(compile)` builds the history out of functions compiled by `compile`: `compiled()`
for the processor (`monte_carlo_kernel.py`), `cuda.jit(device=True)` for a graphics card
(`monte_carlo_cuda.py`). It is the random walk of [wang1992mcml] in a plane (dimension 2) or in
space (3), with photons that lose weight instead of dying. All layers share one refractive index: a
photon keeps its direction and what is left of its optical path when it crosses an interface, so it
stops there before it meets anything else. At the outer boundary a photon splits: what Fresnel lets
through is scored, the rest goes on.

Depths are optical, μt times length, counted from the top of the layer that the photon is in. A
stack is (L, 4): optical depth (inf: a half space), share lost in a collision μa / μt, anisotropy g,
1 / 2g (0 where g = 0). `score` (2 + 2L) gathers the weight reflected, transmitted and absorbed in
each layer, and at the end holds the optical path that the photon had gone in each layer when it
last left that layer.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from cutis.transport.philox import HALF, WORD, philox

FAINT = 0.2
"""Weight below which a photon plays Russian roulette."""
SURVIVAL = 0.3
"""Chance to survive it, with the weight over this chance (docs/decisions/0011)."""
UNIT = 2.0**-32
ZERO, ONE = np.uint64(0), np.uint64(1)


def make_history(compile: Callable[[Any], Any]) -> Any:
    """The function `history(photon, stream, key, stack, dimension, index, incidence, score)`.

    photon, stream, key: uint64, at most 2³² photons; `index` of the layers, air outside (1:
    matched); `incidence`: cosine of a beam inside, 0 for a Lambertian start; `score` starts at 0.
    """
    words = compile(philox)

    @compile
    def uniform(word: Any) -> Any:
        """A 32-bit word as a number inside (0, 1)."""
        return (float(word) + 0.5) * UNIT

    @compile
    def cosine(word: Any) -> Any:
        """Cosine of an angle that is uniform over half a circle: the sine of one about 0."""
        x = (uniform(word) - 0.5) * math.pi
        y = x * x  # Taylor series to 6e-12
        return x * (1.0 + y * (-1 / 6 + y * (1 / 120 + y * (-1 / 5040 + y * (1 / 362880
            + y * (-1 / 39916800 + y * (1 / 6227020800 - y / 1307674368000)))))))  # fmt: skip

    @compile
    def scatter_2d(mu: Any, side: Any, g: Any, first: Any, second: Any) -> Any:
        """Direction (μ, lateral) after a collision in the plane.

        The wrapped Cauchy law of 2-D Henyey–Greenstein is a Möbius map of a uniform direction.
        """
        u = cosine(first)
        v = math.sqrt(max(1.0 - u * u, 0.0)) * (1.0 if second & ONE else -1.0)
        scale = 1.0 / (1.0 + g * g + 2.0 * g * u)
        along = (2.0 * g + u * (1.0 + g * g)) * scale
        across = (1.0 - g * g) * v * scale
        return mu * along - side * across, side * along + mu * across

    @compile
    def scatter_3d(mu: Any, g: Any, half_inverse: Any, first: Any, second: Any) -> Any:
        """μ after a Henyey–Greenstein collision in space [henyey1941]."""
        xi = uniform(first)
        if half_inverse == 0.0:
            along = 2.0 * xi - 1.0
        else:
            ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * xi)
            along = (1.0 + g * g - ratio * ratio) * half_inverse
        sines = math.sqrt(max((1.0 - mu * mu) * (1.0 - along * along), 0.0))
        return mu * along + sines * cosine(second)

    @compile
    def fresnel(mu: Any, index: Any) -> Any:
        """Reflectance, from inside, of the boundary with air at |cos θ| = mu."""
        if index == 1.0:
            return 0.0
        sine2 = (1.0 - mu * mu) * index * index
        if sine2 >= 1.0:
            return 1.0
        far = math.sqrt(1.0 - sine2)
        s = (index * mu - far) / (index * mu + far)
        p = (mu - index * far) / (mu + index * far)
        return 0.5 * (s * s + p * p)

    @compile
    def history(
        photon: Any, stream: Any, key: Any, stack: Any,
        dimension: Any, index: Any, incidence: Any, score: Any
    ) -> None:  # fmt: skip
        stream_low, stream_high = stream & WORD, stream >> HALF
        key_low, key_high = key & WORD, key >> HALF
        step = ZERO
        r0, r1, r2, r3 = words(photon, step, stream_low, stream_high, key_low, key_high)
        side = 0.0
        if incidence > 0.0:
            mu = incidence
            side = math.sqrt(1.0 - mu * mu)
        elif dimension == 2:
            side = 2.0 * uniform(r0) - 1.0
            mu = math.sqrt(1.0 - side * side)
        else:
            mu = math.sqrt(uniform(r0))
        weight, z, path, layer, last = 1.0, 0.0, 0.0, 0, len(stack) - 1
        while True:
            step += ONE
            r0, r1, r2, r3 = words(photon, step, stream_low, stream_high, key_low, key_high)
            left = -math.log(uniform(r0))
            while True:
                reached = z + mu * left
                if 0.0 <= reached <= stack[layer, 0]:
                    path += left
                    z = reached
                    break
                gone = (stack[layer, 0] - z if mu > 0.0 else -z) / mu
                left = max(left - gone, 0.0)
                score[3 + last + layer] += path + gone
                path = 0.0
                if mu > 0.0 and layer < last:
                    layer += 1
                    z = 0.0
                elif mu < 0.0 and layer > 0:
                    layer -= 1
                    z = stack[layer, 0]
                else:
                    kept = weight * fresnel(abs(mu), index)
                    score[1 if mu > 0.0 else 0] += weight - kept
                    if kept == 0.0:
                        return
                    weight = kept
                    z = stack[layer, 0] if mu > 0.0 else 0.0
                    mu = -mu
            lost = weight * stack[layer, 1]
            score[2 + layer] += lost
            weight -= lost
            if weight < FAINT:
                if uniform(r3) >= SURVIVAL:
                    return
                weight /= SURVIVAL
            if dimension == 2:
                mu, side = scatter_2d(mu, side, stack[layer, 2], r1, r2)
            else:
                mu = scatter_3d(mu, stack[layer, 2], stack[layer, 3], r1, r2)

    return history
