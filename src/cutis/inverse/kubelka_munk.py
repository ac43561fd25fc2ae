"""Inverse of the Kubelka–Munk skin: the nearest colour on its two-dimensional surface.

The surface is tabulated finely over the roots in which skins are even, searched for the nearest
node exactly, and left from there by one Gauss–Newton step.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.inverse.lookup import curve_order, search_tree
from cutis.optics import PARAMETERS, to_coordinates
from cutis.optics.parameters import BLOOD, MELANIN

NODES = (1024, 512)
"""Nodes along melanin and along blood."""


@dataclass(frozen=True, eq=False)
class KubelkaMunkInverse:
    """Colour → skin and back for one `KubelkaMunkSkin`."""

    skin: KubelkaMunkSkin

    @cached_property
    def _axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Roots of melanin and of blood at the nodes."""
        ranges = zip((self.skin.melanin, self.skin.blood), (MELANIN, BLOOD), strict=True)
        melanin, blood = (
            np.linspace(low ** (1 / p.root), high ** (1 / p.root), count)
            for ((low, high), p), count in zip(ranges, NODES, strict=True)
        )
        return melanin, blood

    @cached_property
    def _colours(self) -> NDArray[np.float64]:
        melanin, blood = self._axes
        return self.skin.rgb(melanin[:, None] ** MELANIN.root, blood[None, :] ** BLOOD.root)

    @cached_property
    def _away(self) -> NDArray[np.float64]:
        """(nodes, 2, 3) how far to go in cells of either axis per difference in colour."""
        slope = np.stack(list(np.gradient(self._colours, axis=(0, 1))), axis=-1).reshape(-1, 3, 2)
        return np.linalg.pinv(slope, rcond=1e-4)

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
        missing = queries - self._colours.reshape(-1, 3)[nearest]
        step = np.clip((self._away[nearest] @ missing[..., None])[..., 0], -0.5, 0.5)
        cells = np.stack(np.divmod(nearest, NODES[1]), axis=-1) + step
        return np.stack(
            [np.interp(cells[:, i], np.arange(NODES[i]), self._axes[i]) for i in range(2)], -1
        )

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
        return np.stack([s.ev(melanin, blood) for s in self._surface], -1).astype(np.float32)


@lru_cache(maxsize=4)
def kubelka_munk_inverse(skin: KubelkaMunkSkin | None = None) -> KubelkaMunkInverse:
    """The inverse of `skin` (the default one), its table made once per process."""
    return KubelkaMunkInverse(skin or KubelkaMunkSkin())
