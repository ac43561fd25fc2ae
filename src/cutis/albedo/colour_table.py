"""The albedo space in linear sRGB as one small table, for decoding at the speed of memory.

RGB of all skins is, to 0.01 ΔE00, a sum of sixteen products of what is above and what is below:

    RGB_c = Σ_r upper_r(melanin, eumelanin share, thickness) · lower_cr(blood, oxygenation).

Factors are those of a singular value decomposition of the exact space at Chebyshev nodes, skins
weighted by 1 / (mean albedo + 0.01) as eyes weight them, and become uniform quadratic B-splines
over p^¼ of melanin and of blood, t / (t + 60 µm), and the shares themselves. `AlbedoSpace.rgb` is
the exact form. Errors: docs/albedo.md; built by studies/build_albedo_table.py.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import resources
from typing import IO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.albedo.space import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import to_splines
from cutis.kernels.splines import basis, chebyshev
from cutis.optics import TISSUES, Tissue
from cutis.optics.parameters import BLOOD, EUMELANIN, MELANIN, OXYGENATION, PARAMETERS, THICKNESS

TERMS = 16
"""Products: the lanes of a vector."""
AXES = (MELANIN, EUMELANIN, THICKNESS, BLOOD, OXYGENATION)
"""Parameters in the order of the tables' axes: three of `upper`, two of `lower`."""
NODES = (20, 10, 14, 20, 10)
"""Chebyshev points over each, where the exact space is sampled."""
CELLS = (24, 8, 14, 24, 12)
"""Cells of the quadratic B-splines over each."""
HALF = 60.0
"""Thickness, µm, where t / (t + HALF) is a half."""
DARK = 0.01
"""Albedo added to the weight, so that the darkest skins do not rule the factors."""


def to_axis(axis: int, value: ArrayLike) -> NDArray[np.floating]:
    """Parameter AXES[axis] in its unit → coordinate of that axis."""
    v = np.asarray(value)
    if AXES[axis] in (MELANIN, BLOOD):
        return v**0.25
    return v / (v + HALF) if AXES[axis] is THICKNESS else v


def from_axis(axis: int, coordinate: ArrayLike) -> NDArray[np.floating]:
    """The inverse of `to_axis`."""
    u = np.asarray(coordinate)
    if AXES[axis] in (MELANIN, BLOOD):
        return u**4
    return HALF * u / (1 - u) if AXES[axis] is THICKNESS else u


ENDS = tuple((float(to_axis(i, p.low)), float(to_axis(i, p.high))) for i, p in enumerate(AXES))
"""Low and high coordinate of each axis."""


@dataclass(frozen=True, eq=False)
class ColourTable:
    """B-spline coefficients, float32: `upper` (M+2, E+2, T+2, 16), `lower` (3, B+2, O+2, 16)."""

    upper: NDArray[np.float32]
    lower: NDArray[np.float32]

    def rgb(self, parameters: ArrayLike) -> NDArray[np.float32]:
        """(..., 5) parameters in their units → (..., 3) linear sRGB under D65."""
        from cutis.albedo.colour_table_kernel import decode_kernel

        skins = np.ascontiguousarray(parameters, dtype=np.float32)
        flat = skins.reshape(-1, len(PARAMETERS))
        out = np.empty((len(flat), 3), dtype=np.float32)
        half = np.float32(HALF)
        decode_kernel(len(flat), flat, self.upper, self.lower, *self._scaling, half, out)
        return out.reshape(*skins.shape[:-1], 3)

    @cached_property
    def _scaling(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        low, high = np.array(ENDS).T
        return low.astype(np.float32), (np.array(CELLS) / (high - low)).astype(np.float32)

    def reference(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """The same in plain float64 NumPy, (n, 5) → (n, 3): the oracle of the fast form."""
        skins = np.asarray(parameters, dtype=np.float64)
        bases = []
        for axis, (cells, (low, high)) in enumerate(zip(CELLS, ENDS, strict=True)):
            values = skins[:, PARAMETERS.index(AXES[axis])]
            x = (np.asarray(to_axis(axis, values), float) - low) / (high - low)
            bases.append(basis(x, cells, degree=2))
        above = np.einsum("nm,ne,nt,metr->nr", *bases[:3], self.upper, optimize=True)
        below = np.einsum("nb,no,cbor->ncr", *bases[3:], self.lower, optimize=True)
        return np.einsum("nr,ncr->nc", above, below)


def build_colours(space: AlbedoSpace) -> ColourTable:
    """Decomposes the exact space of a tissue with the five free parameters; a second."""
    points = [
        from_axis(i, low + chebyshev(n) * (high - low))
        for i, (n, (low, high)) in enumerate(zip(NODES, ENDS, strict=True))
    ]
    grid = np.meshgrid(*points, indexing="ij")
    skins = np.stack([grid[AXES.index(p)] for p in PARAMETERS], axis=-1).reshape(-1, 5)
    rgb = space.rgb(skins).astype(np.float64)
    above = int(np.prod(NODES[:3]))
    weight = 1 / (rgb.reshape(above, -1).mean(axis=1, keepdims=True) + DARK)
    left, sizes, right = np.linalg.svd(weight * rgb.reshape(above, -1), full_matrices=False)
    share = np.sqrt(sizes[:TERMS])
    upper = (left[:, :TERMS] * share / weight).reshape(*NODES[:3], TERMS)
    lower = (right[:TERMS].T * share).reshape(*NODES[3:], 3, TERMS)
    to_spline = [to_splines(n, cells, 2) for n, cells in zip(NODES, CELLS, strict=True)]
    upper = np.einsum("am,be,ct,metr->abcr", *to_spline[:3], upper, optimize=True)
    lower = np.einsum("ab,do,bocr->cadr", *to_spline[3:], lower, optimize=True)
    return ColourTable(
        np.ascontiguousarray(upper, dtype=np.float32), np.ascontiguousarray(lower, dtype=np.float32)
    )


def save_colours(table: ColourTable, file: str | IO[bytes]) -> None:
    """Writes the coefficients as .npz, without pickle."""
    np.savez_compressed(file, upper=table.upper, lower=table.lower)


def load_colours(file: str | IO[bytes]) -> ColourTable:
    """Reads what `save_colours` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        return ColourTable(stored["upper"], stored["lower"])


def colour_table(tissue: Tissue) -> ColourTable:
    """The table of `tissue`: the one that ships where there is one, else built now (seconds)."""
    return _colour_table(tissue)


@lru_cache(maxsize=4)
def _colour_table(tissue: Tissue) -> ColourTable:
    shipped = resources.files("cutis.data").joinpath("albedo", f"{tissue.name}-rgb.npz")
    if tissue in TISSUES.values() and shipped.is_file():
        with shipped.open("rb") as file:
            return load_colours(file)
    return build_colours(albedo_space(tissue))
