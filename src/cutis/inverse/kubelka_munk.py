"""Inverse of the Kubelka–Munk skin: the nearest colour on its two-dimensional surface.

The surface is tabulated, even in the roots in which skins are even, as bicubic B-splines. The node
nearest to a colour is found exactly, and Newton's method goes downhill from there.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.kernels.nearest import NearestColour, finite_colours
from cutis.kernels.splines import through_nodes
from cutis.optics import PARAMETERS, to_coordinates
from cutis.optics.parameters import BLOOD, MELANIN

CELLS = (256, 128)
"""Cells of the surface along melanin and along blood."""
ROOTS = np.array([MELANIN.root, BLOOD.root])


@dataclass(frozen=True, eq=False)
class KubelkaMunkInverse:
    """Colour → skin and back for one `KubelkaMunkSkin`."""

    skin: KubelkaMunkSkin

    @cached_property
    def _ends(self) -> NDArray[np.float64]:
        """(2, 2) lowest and highest melanin, blood."""
        return np.array([self.skin.melanin, self.skin.blood]).T

    @cached_property
    def _colours(self) -> NDArray[np.float64]:
        """Colours at the corners of all cells."""
        low, high = self._ends ** (1 / ROOTS)
        melanin, blood = (np.linspace(low[i], high[i], CELLS[i] + 1) ** ROOTS[i] for i in range(2))
        return self.skin.rgb(melanin[:, None], blood[None, :])

    @cached_property
    def _table(self) -> NDArray[np.float64]:
        """B-spline coefficients of the surface, one more than corners at each end."""
        return through_nodes(self._colours, 2, "not-a-knot")

    @cached_property
    def _tree(self) -> NearestColour:
        return NearestColour(self._colours.reshape(-1, 3).astype(np.float32))

    def nearest(self, colours: ArrayLike) -> NDArray[np.float64]:
        """(n, 3) linear sRGB → (n, 2) melanin and blood of the nearest point on the surface.

        Raises CutisError for colours that are not finite.
        """
        from cutis.inverse.kubelka_munk_kernel import nearest_point_kernel

        queries = finite_colours(colours)
        node = self._tree(queries)
        cells = np.stack(np.divmod(node, CELLS[1] + 1), axis=-1).astype(np.float64)
        nearest_point_kernel(len(queries), queries, self._table, cells)
        first, last = self._ends ** (1 / ROOTS)
        return np.clip((first + cells / CELLS * (last - first)) ** ROOTS, *self._ends)

    def encode(self, colours: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 3) linear sRGB → (n, 5) network coordinates, what the skin holds in all of them."""
        found = self.nearest(colours)
        skins = np.empty((len(found), len(PARAMETERS)))
        skins[:, :2] = found
        skins[:, 2:] = self.skin.thickness, self.skin.eumelanin, self.skin.oxygenation
        return to_coordinates(skins).astype(np.float32)

    def decode(self, skins: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n, 5) parameters → (n, 3) linear sRGB; only melanin and blood are heeded."""
        from cutis.inverse.kubelka_munk_kernel import surface_kernel

        first, last = self._ends ** (1 / ROOTS)
        roots = np.clip(skins[:, :2].astype(np.float64), *self._ends) ** (1 / ROOTS)
        out = np.empty((len(skins), 3), dtype=np.float32)
        cells = (roots - first) / (last - first) * CELLS
        surface_kernel(len(skins), cells, self._table, out)
        return out


@lru_cache(maxsize=4)
def kubelka_munk_inverse(skin: KubelkaMunkSkin) -> KubelkaMunkInverse:
    """The inverse of `skin`, its table made once per process."""
    return KubelkaMunkInverse(skin)
