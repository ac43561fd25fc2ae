"""Inverse of the Kubelka–Munk skin: the nearest colour on its two-dimensional surface.

The surface is tabulated over the roots in which skins are even, searched for the nearest node
exactly, and followed from there by Gauss–Newton steps on bicubic splines.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.inverse.lookup import curve_order, search_tree
from cutis.optics import PARAMETERS, to_coordinates
from cutis.optics.parameters import BLOOD, MELANIN

NODES = 240
"""Nodes along melanin and along blood."""
STEPS = 6
"""Gauss–Newton steps from the nearest node."""


@dataclass(frozen=True, eq=False)
class KubelkaMunkInverse:
    """Colour → skin and back for one `KubelkaMunkSkin`."""

    skin: KubelkaMunkSkin

    @cached_property
    def _axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Roots of melanin and of blood at the nodes."""
        ranges = zip((self.skin.melanin, self.skin.blood), (MELANIN, BLOOD), strict=True)
        melanin, blood = (
            np.linspace(low ** (1 / p.root), high ** (1 / p.root), NODES)
            for (low, high), p in ranges
        )
        return melanin, blood

    @cached_property
    def _colours(self) -> NDArray[np.float64]:
        melanin, blood = self._axes
        return self.skin.rgb(melanin[:, None] ** MELANIN.root, blood[None, :] ** BLOOD.root)

    @cached_property
    def _surface(self) -> list:
        """A bicubic spline per channel over the roots."""
        from scipy.interpolate import RectBivariateSpline

        return [RectBivariateSpline(*self._axes, self._colours[..., c]) for c in range(3)]

    @cached_property
    def _tree(self) -> tuple[NDArray[np.generic], ...]:
        return search_tree(self._colours.reshape(-1, 3).astype(np.float32))

    def roots(self, colours: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n, 3) linear sRGB → (n, 2) roots of melanin and blood on the nearest point."""
        from cutis.inverse.lookup_kernel import nearest_kernel

        queries = np.ascontiguousarray(colours, dtype=np.float32)
        nearest = np.empty(len(queries), dtype=np.int64)
        points, index, low, high, starts = self._tree
        order = curve_order(queries)
        nearest_kernel(queries, order, points, index, low, high, starts, nearest)
        axes = self._axes
        x = np.stack([axes[0][nearest // NODES], axes[1][nearest % NODES]], axis=-1)
        cell = np.array([axis[1] - axis[0] for axis in axes])
        ends = np.array([[axis[0] for axis in axes], [axis[-1] for axis in axes]])
        length = np.ones((len(x), 1))
        missing = queries - self._at(x)
        for _ in range(STEPS):
            slope = np.stack([self._at(x, 1, 0), self._at(x, 0, 1)], axis=-1)
            gradient = np.einsum("nci,nc->ni", slope, missing)
            normal = np.einsum("nci,ncj->nij", slope, slope) + 1e-12 * np.eye(2)
            step = np.linalg.solve(normal, gradient[..., None])[..., 0]
            for held, free in ((0, 1), (1, 0)):  # against an end: move along it
                stuck = ((x == ends[0]) & (step < 0) | (x == ends[1]) & (step > 0))[:, held]
                step[stuck, free] = (gradient[:, free] / normal[:, free, free])[stuck]
            trial = np.clip(x + length * np.clip(step, -cell, cell), *ends)
            left = queries - self._at(trial)
            better = (left**2).sum(axis=1) < (missing**2).sum(axis=1)
            x[better], missing[better] = trial[better], left[better]
            length[~better] *= 0.25
        return x

    def _at(self, x: NDArray[np.float64], *derivative: int) -> NDArray[np.float64]:
        """(n, 3) colours, or their slopes, at (n, 2) roots."""
        return np.stack([s.ev(x[:, 0], x[:, 1], *derivative) for s in self._surface], axis=-1)

    def encode(self, colours: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 3) linear sRGB → (n, 5) network coordinates, what the skin holds in all of them."""
        roots = self.roots(colours)
        skins = np.empty((len(roots), len(PARAMETERS)))
        skins[:, 0] = roots[:, 0] ** MELANIN.root
        skins[:, 1] = roots[:, 1] ** BLOOD.root
        skins[:, 2:] = self.skin.thickness, self.skin.eumelanin, self.skin.oxygenation
        return to_coordinates(skins).astype(np.float32)

    def decode(self, skins: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 5) parameters → (n, 3) linear sRGB; only melanin and blood are heeded."""
        melanin, blood = (
            np.clip(skins[:, i], *limits) ** (1 / p.root)
            for i, (limits, p) in enumerate(
                ((self.skin.melanin, MELANIN), (self.skin.blood, BLOOD))
            )
        )
        return self._at(np.stack([melanin, blood], axis=-1)).astype(np.float32)


@lru_cache(maxsize=4)
def kubelka_munk_inverse(skin: KubelkaMunkSkin | None = None) -> KubelkaMunkInverse:
    """The inverse of `skin` (the default one), its table made once per process."""
    return KubelkaMunkInverse(skin or KubelkaMunkSkin())
