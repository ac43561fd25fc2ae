"""Maps that keep still: weak maps are what their neighbours expect, as far as the colour allows.

A colour fixes melanin and blood well, and leaves thickness, melanin type and oxygenation to what is
most probable, so that these three carry what noise there is. With u the coordinates of each texel's
own estimate, they are first expected to be locally linear in melanin and blood (a guided filter
[he2013guided] on cells of CELL² texels, whose lines are interpolated between cells):

    w̄ = A u_strong + c,    minimising Σ (A u_strong + c − u_weak)² + |A EDGE|²

over 3 × 3 cells. Where strong maps hardly vary this is the mean, at their edges it follows them.
Then the colour decides: with u₀ = (u_strong, w̄), what neighbours expect, J the slopes of the colour
and f the decoder,

    u = u₀ + K (c − f(u₀)),    K = Π Jᵀ (J Π Jᵀ + R)⁻¹,

is the most probable skin whose weak maps lie around w̄ by some of their σ, Π = diag(FREE², …), whose
strong maps are free, and whose colour is known up to the covariance R: UNSEEN in CIEDE2000, and
the rounding of 8-bit files, whose noise is not explained. Of such files strong maps are expected
to be the mean of 3 × 3 texels, within FINE. K and J are functions of the colour, tabulated once.
The step is done twice, since f is not linear, and texels that it leaves with another colour keep
their own estimate.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from cutis.colour.difference import lab
from cutis.colour.transfer import decode_srgb, encode_srgb
from cutis.inverse.baked import AXES, Baked, Chart
from cutis.inverse.model import Found, Map, Model, State, spread, texels
from cutis.inverse.prior import unit_slopes
from cutis.optics import NAMES

CELL = 8
"""Texels of a cell along each side."""
REACH = 3 * CELL
"""Texels around one that decide on it: its cell, two on either side."""
EDGE = (0.05, 0.08)
"""Spread of melanin and of blood, in coordinates, that is an edge: lips, moles, freckles."""
FREE = (0.65, 0.21, 0.37)
"""Standard deviation of thickness, type and oxygenation around what neighbours expect, over σ."""
MOST = (0.13, 0.17, 0.18)
"""The largest σ that counts there, in coordinates."""
STRONG = 0.5
"""Standard deviation of melanin and blood around their own estimate: free."""
FINE = 0.08
"""The same around the mean of their neighbours, where colours are rounded."""
ROUNDED = 12**-0.5
"""Standard deviation of a rounding by one step."""
UNSEEN = 0.1
"""CIEDE2000 that nobody sees."""
LIMIT = 0.018
"""Relative error of a colour at which a texel's own estimate counts again as much."""
NODES = (24, 20, 20)
"""Cells of the table of gains along the axes of the chart."""
SLOPE = 2e-3
"""Coordinates either side of a skin between which slopes are taken."""

STEADINESS = (
    CELL, REACH, EDGE, FREE, MOST, STRONG, FINE, ROUNDED, UNSEEN, LIMIT, NODES, SLOPE,
)  # fmt: skip
"""All constants: results depend on them."""
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Steady:
    """The steady form of a baked inverse; `skins` are coordinates, `rgb` decodes units."""

    skins: Baked
    rgb: Callable[[Map], Map]
    trust: Callable[[Map], Map]

    def __call__(self, colours: Map, cover: Map, state: State, sigma: bool) -> Found:
        """What is found in a tile; `state["rounding"]`, if any, is the step of encoded colours."""
        inside = cover > 0
        chosen = np.ascontiguousarray(texels(colours, inside), dtype=np.float32)
        own = self.skins(chosen)
        steady = self.steadied(colours, inside, own, float(state.get("rounding", 0.0)))
        return Found(dict(zip(NAMES, spread(_units(steady), inside), strict=True)))

    def steadied(
        self, colours: Map, inside: NDArray[np.bool_], own: Map, rounding: float = 0.0
    ) -> Map:
        """(n, 5) coordinates of the texels `inside` (h, W), of their `own` ones (n, 5)."""
        from cutis.inverse import steady_kernel as kernel

        if not inside.any():
            return own
        gains, (low, scale) = self.gains(rounding), self._scaling
        expected = np.zeros((*inside.shape, 5), dtype=np.float32)
        u = own.reshape(expected.shape) if inside.all() else np.zeros_like(expected)
        if not inside.all():
            u[inside] = own
        seen = np.ascontiguousarray(colours, dtype=np.float32)
        shape = tuple(-(-n // CELL) for n in inside.shape)
        sums = np.zeros((*shape, kernel.SUMS))
        kernel.sum_cells(shape[0], CELL, u, seen, inside, gains, low, scale, sums)
        lines = guided(around(sums))
        kernel.expect(shape[0], CELL, u, inside, lines, rounding > 0, expected)
        chosen, before = texels(seen, inside), texels(expected, inside)
        at = before
        for limit in (0.0, LIMIT):
            decoded, found = self.rgb(_units(at)), np.empty_like(at)
            kernel.correct(
                len(at), chosen, before, at, decoded, own, gains, low, scale, np.float32(limit),
                found,
            )  # fmt: skip
            at = found
        return at

    @cached_property
    def _chart(self) -> Chart:
        return Chart(self.skins.chart.low, self.skins.chart.high, NODES)

    @cached_property
    def _scaling(self) -> tuple[Map, Map]:
        low, high = np.array(self._chart.low), np.array(self._chart.high)
        return low.astype(np.float32), (np.array(NODES) / (high - low)).astype(np.float32)

    def gains(self, rounding: float) -> Map:
        """(a, b, c, 32): K (5, 3), J (3, 5) and confidence of the colours of a chart, then 0."""
        return _gains(self, rounding)

    def slopes(self, coordinates: Map) -> Array:
        """(n, 5) → (n, 3, 5): slopes of the decoder by coordinates."""
        found = np.empty((len(coordinates), 3, 5))
        for p in range(5):
            ends = np.repeat(coordinates[None], 2, axis=0)
            ends[:, :, p] = np.clip(ends[:, :, p] + np.array([[-SLOPE], [SLOPE]]), 0, 1)
            below, above = (self.rgb(_units(end)).astype(np.float64) for end in ends)
            found[:, :, p] = (above - below) / (ends[1] - ends[0])[:, p, None]
        return found


@lru_cache(maxsize=8)
def _gains(steady: Steady, rounding: float) -> Map:
    colours = steady._chart.colours()
    u = steady.skins(colours)
    trust = steady.trust(colours).astype(np.float64)
    sigma = trust[:, 2:5] / unit_slopes(np.clip(u, 0.01, 0.99).astype(np.float64))[:, 2:]
    deviation = np.empty((len(u), 5))
    deviation[:, :2] = FINE if rounding else STRONG
    deviation[:, 2:] = np.array(FREE) * np.minimum(sigma, MOST)
    slopes = steady.slopes(u)
    lever = slopes * (deviation**2)[:, None, :]
    inner = lever @ np.swapaxes(slopes, 1, 2) + unseen(colours)
    if rounding:
        noise = ROUNDED * rounding * _decoding_slope(colours)
        inner += noise[:, :, None] ** 2 * np.eye(3)
    gain = np.swapaxes(np.linalg.solve(inner, lever), 1, 2)
    lanes = np.zeros((len(u), 32), dtype=np.float32)
    lanes[:, :15], lanes[:, 15:30] = gain.reshape(-1, 15), slopes.reshape(-1, 15)
    lanes[:, 30] = np.maximum(trust[:, 5], 1e-3)
    return lanes.reshape(*(n + 1 for n in NODES), 32)


def unseen(colours: Map) -> Array:
    """(n, 3) linear sRGB → (n, 3, 3) covariance of colours that differ by UNSEEN in CIEDE2000.

    To first order, without the terms of hue: ΔL, ΔC / (1 + 0.045 C) and ΔH / (1 + 0.015 C).
    """
    at, step = np.maximum(colours.astype(np.float64), 1e-4), 1e-4
    slopes = np.stack(
        [(lab(at + step * unit).astype(np.float64) - lab(at)) / step for unit in np.eye(3)], axis=-1
    )
    a, b = lab(at).astype(np.float64)[:, 1:].T
    chroma = np.maximum(np.hypot(a, b), 1e-3)
    turn = np.zeros((len(at), 3, 3))
    turn[:, 0, 0] = 1
    turn[:, 1, 1:] = np.stack([a, b], 1) / (chroma * (1 + 0.045 * chroma))[:, None]
    turn[:, 2, 1:] = np.stack([-b, a], 1) / (chroma * (1 + 0.015 * chroma))[:, None]
    by_colour = turn @ slopes
    inner = np.swapaxes(by_colour, 1, 2) @ by_colour
    return np.asarray(UNSEEN**2 * np.linalg.inv(inner))


def _decoding_slope(colours: Map) -> Array:
    """(n, 3) linear sRGB → slopes of it by its encoded form."""
    encoded = encode_srgb(np.clip(colours.astype(np.float64), 0, 1))
    return np.asarray((decode_srgb(encoded + 1e-4) - decode_srgb(encoded - 1e-4)) / 2e-4)


def around(sums: Array) -> Array:
    """Sums over cells (h, w, k) → weighted sums, 1 2 1 along both axes, over 3 × 3 of them."""
    wide = np.pad(sums, ((1, 1), (1, 1), (0, 0)))
    rows = wide[:-2] + 2 * wide[1:-1] + wide[2:]
    return np.asarray(rows[:, :-2] + 2 * rows[:, 1:-1] + rows[:, 2:])


def guided(sums: Array) -> Map:
    """Sums (h, w, 15) of `steady_kernel.sum_cells` → lines (h, w, 9): A (2, 3), then c (3)."""
    means = sums / np.maximum(sums[..., :1], 1e-12)
    strong, weak = means[..., 1:3], means[..., 6:9]
    mm = means[..., 3] - strong[..., 0] ** 2 + EDGE[0] ** 2
    ms = means[..., 4] - strong[..., 0] * strong[..., 1]
    ss = means[..., 5] - strong[..., 1] ** 2 + EDGE[1] ** 2
    by_m = means[..., 9:12] - strong[..., :1] * weak
    by_s = means[..., 12:15] - strong[..., 1:] * weak
    size = (mm * ss - ms**2)[..., None]
    first = (ss[..., None] * by_m - ms[..., None] * by_s) / size
    second = (mm[..., None] * by_s - ms[..., None] * by_m) / size
    constant = weak - first * strong[..., :1] - second * strong[..., 1:]
    return np.concatenate([first, second, constant], axis=-1).astype(np.float32)


def _units(coordinates: Map) -> Map:
    from cutis.kernels.warp_kernel import to_units

    return np.asarray(to_units(np.ascontiguousarray(coordinates), AXES))


def steadied(model: Model, skins: Baked) -> Model:
    """A baked model with σ, that looks at neighbours."""
    assert model.to_trust is not None
    found = Steady(skins, model.to_rgb, model.to_trust)
    return replace(model, reach=REACH, grid=CELL, of_tile=found)
