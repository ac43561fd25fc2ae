"""The albedo of a tissue at every wavelength, tabulated from the exact solver.

At each wavelength the albedo depends on three numbers only: absorption of epidermis and of
dermis, and thickness. In the coordinates μa^¼ and log t it is so smooth that NODES Chebyshev
points per axis carry it to 2e-6; for evaluation they are turned, once, into uniform cubic
B-splines of CELLS cells, whose values and gradients are cheap (`separated.py`). Worst error against
the solver over the whole range: docs/albedo.md.
"""

import json
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from importlib import resources
from itertools import product
from typing import IO

import numpy as np
from numpy.typing import NDArray

from cutis.kernels.mixture import WITHOUT, absorption
from cutis.kernels.splines import along, chebyshev, from_chebyshev
from cutis.optics import WAVELENGTHS, Parameter, Tissue
from cutis.optics.parameters import THICKNESS
from cutis.transport import two_layer_albedo

NODES = (18, 18, 16)
"""Chebyshev points over epidermis absorption, dermis absorption and thickness."""
CELLS = (24, 24, 16)
"""Cells of the cubic B-splines over the same axes."""
LEAST = 1e-9
"""cm⁻¹ from which the axes begin in layers that absorb nothing."""
NEARLY = 0.002
ORDINATES = 24
"""Directions per hemisphere; the albedo is then converged to 5e-6, or 2e-5 with a Fresnel
boundary (docs/transport.md)."""


@dataclass(frozen=True, eq=False)
class SpectralTable:
    """Albedo at the 41 wavelengths, with the range of each axis.

    `nodes` (41, NODES…) are exact albedos; `low`, `high` (41, 3) ends of μa_e^¼, μa_d^¼ and log t.
    """

    tissue: Tissue
    nodes: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @cached_property
    def coefficients(self) -> NDArray[np.float32]:
        """(41, E+3, D+3, T+3) B-spline coefficients; what is evaluated is in `separated.py`."""
        found = self.nodes
        for axis, (nodes, cells) in enumerate(zip(NODES, CELLS, strict=True)):
            found = along(to_splines(nodes, cells), found, axis + 1)
        return np.ascontiguousarray(found, dtype=np.float32)


def axis_ranges(tissue: Tissue) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(41, 3) lowest and highest μa_e^¼, μa_d^¼ and log t that the parameter ranges reach.

    Absorption, that of the dermis for its scattering at no eumelanin, is linear in every parameter,
    so its ends are at ends of these. A thickness that is
    the same for all skins has a narrow range around it.
    """
    low, high = [], []
    recipe, *layers = tissue.mixture(WAVELENGTHS)
    first = 0
    for pure in layers:
        rows = recipe[first : first + len(pure) - 1]
        first += len(rows)
        some = np.flatnonzero((rows != 0).any(axis=0))
        blends = (rows == WITHOUT).any(axis=0)
        ends = (_ends(tissue.every_parameter[i], bool(blends[i])) for i in some)
        corners = np.array(list(product(*ends)))
        found = absorption(corners, rows[:, some], pure)
        low.append(np.maximum(found.min(0), LEAST) ** 0.25)
        high.append(found.max(0) ** 0.25)
    ones = np.ones(len(WAVELENGTHS))
    held = dict(tissue.fixed).get("thickness")
    thin, thick = (THICKNESS.low, THICKNESS.high) if held is None else (held / 1.01, held * 1.01)
    low.append(np.log(thin) * ones)
    high.append(np.log(thick) * ones)
    return np.stack(low, -1), np.stack(high, -1)


def _ends(known: Parameter, blend: bool) -> tuple[float, float]:
    """Of a parameter; a share of one substance of two goes all the way where it nearly does."""
    low, high = known.low, known.high
    return (0.0 if blend and low < NEARLY else low), (1.0 if blend and high > 1 - NEARLY else high)


def build(tissue: Tissue, progress: Callable[[int, int], None] | None = None) -> SpectralTable:
    """Solves transport exactly at every node (212 544 cases, seconds on two cores).

    `progress(done, total)` is called after each wavelength.
    """
    tissue.check()
    low, high = axis_ranges(tissue)

    def solve(i: int) -> NDArray[np.float64]:
        axes = [low[i, a] + chebyshev(NODES[a]) * (high[i, a] - low[i, a]) for a in range(3)]
        return two_layer_albedo(
            axes[0] ** 4,
            axes[1] ** 4,
            np.exp(axes[2]),
            float(tissue.scattering(WAVELENGTHS)[i]),
            float(tissue.anisotropy(WAVELENGTHS)[i]),
            dimension=tissue.dimension,
            refractive_index=tissue.outer_index,
            count=ORDINATES,
            dermis_scattering=float(tissue.scattering_below(WAVELENGTHS)[i]),
        )

    nodes = np.empty((len(WAVELENGTHS), *NODES))
    with ThreadPoolExecutor() as pool:
        for i, solved in enumerate(pool.map(solve, range(len(WAVELENGTHS)))):
            nodes[i] = solved
            if progress:
                progress(i + 1, len(WAVELENGTHS))
    return SpectralTable(tissue, nodes, low, high)


def save(table: SpectralTable, file: str | IO[bytes]) -> None:
    """Writes the nodes and the tissue's constants as .npz, without pickle."""
    constants = np.array(json.dumps(asdict(table.tissue)))
    np.savez_compressed(file, nodes=table.nodes.astype(np.float32), tissue=constants)


def load(file: str | IO[bytes]) -> SpectralTable:
    """Reads what `save` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        tissue = Tissue(**json.loads(str(stored["tissue"])))
        return SpectralTable(tissue, stored["nodes"].astype(np.float64), *axis_ranges(tissue))


def table_file(tissue: Tissue) -> str:
    """The name that the table of a tissue ships under."""
    return f"{tissue.name}{'-rare' if tissue.rare_chromophores else ''}.npz"


def spectral_table(tissue: Tissue) -> SpectralTable:
    """The table of `tissue`: the one that ships where there is one, else built now (seconds)."""
    return _spectral_table(tissue)


@lru_cache(maxsize=4)
def _spectral_table(tissue: Tissue) -> SpectralTable:
    shipped = resources.files("cutis.data").joinpath("albedo", table_file(tissue))
    if shipped.is_file():
        with shipped.open("rb") as file:
            table = load(file)
        if table.tissue == tissue:
            return table
    return build(tissue)


@lru_cache(maxsize=16)
def to_splines(nodes: int, cells: int, degree: int = 3) -> NDArray[np.float64]:
    """(cells + degree, nodes) matrix from values at Chebyshev points to B-splines."""
    return from_chebyshev(nodes, cells, degree)
