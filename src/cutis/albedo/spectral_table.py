"""The albedo of a tissue at every wavelength, tabulated from the exact solver.

At each wavelength the albedo depends on three numbers only: absorption of epidermis and of
dermis, and thickness. In the coordinates μa^¼ and log t it is so smooth that NODES Chebyshev
points per axis carry it to 2e-6; for evaluation they are turned, once, into uniform cubic
B-splines of CELLS cells, whose values and gradients are cheap (`spline.py`). Worst error against
the solver over the whole range: docs/albedo.md.
"""

import json
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import lru_cache
from importlib import resources
from typing import IO

import numpy as np
from numpy.typing import NDArray

from cutis.optics import ALIAGA2022, WAVELENGTHS, Tissue
from cutis.optics.parameters import (
    BILIRUBIN,
    BLOOD,
    CAROTENE,
    EPIDERMAL_BLOOD,
    MELANIN,
    METHAEMOGLOBIN,
    THICKNESS,
)
from cutis.transport import two_layer_albedo

NODES = (18, 18, 16)
"""Chebyshev points over epidermis absorption, dermis absorption and thickness."""
CELLS = (24, 24, 16)
"""Cells of the cubic B-splines over the same axes."""
ORDINATES = 24
"""Directions per hemisphere; the albedo is then converged to 5e-6, or 2e-5 with a Fresnel
boundary (docs/transport.md)."""


@dataclass(frozen=True)
class SpectralTable:
    """Albedo at the 41 wavelengths as B-spline coefficients, with the range of each axis.

    `coefficients` (41, E+3, D+3, T+3) float32; `low`, `high` (41, 3) ends of μa_e^¼, μa_d^¼ and
    log t. `nodes` (41, NODES…) are the exact albedos that it was made from.
    """

    tissue: Tissue
    nodes: NDArray[np.float64]
    coefficients: NDArray[np.float32]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def axis_ranges(tissue: Tissue) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(41, 3) lowest and highest μa_e^¼, μa_d^¼ and log t that the parameter ranges reach.

    A thickness that is the same for all skins has a narrow range around it.
    """
    share = np.array([0.0, 0.0, 1.0, 1.0])
    melanin = np.array([MELANIN.low, MELANIN.high, MELANIN.low, MELANIN.high])
    blood = np.array([BLOOD.low, BLOOD.high, BLOOD.low, BLOOD.high])
    epidermis = tissue.epidermis_absorption(melanin, share, WAVELENGTHS)
    dermis = tissue.dermis_absorption(blood, share, WAVELENGTHS)
    if tissue.rare_chromophores:
        yellow, orange, met = BILIRUBIN.high, CAROTENE.high, METHAEMOGLOBIN.high
        most = tissue.epidermis_absorption(melanin, share, WAVELENGTHS, orange)
        epidermis = np.concatenate([epidermis, most])
        all_met = [
            tissue.dermis_absorption(blood, share, WAVELENGTHS, *added, met)
            for added in ((0.0, 0.0), (yellow, orange))
        ]
        most = tissue.dermis_absorption(blood, share, WAVELENGTHS, yellow, orange)
        dermis = np.concatenate([dermis, most, *all_met])
    if tissue.epidermal_blood:
        epidermis += np.array([[0.0], [EPIDERMAL_BLOOD.high]]).repeat(2, 0) * dermis.max(0)
    ones = np.ones(len(WAVELENGTHS))
    held = dict(tissue.fixed).get("thickness")
    thin, thick = (THICKNESS.low, THICKNESS.high) if held is None else (held / 1.01, held * 1.01)
    low = [epidermis.min(0) ** 0.25, dermis.min(0) ** 0.25, np.log(thin) * ones]
    high = [epidermis.max(0) ** 0.25, dermis.max(0) ** 0.25, np.log(thick) * ones]
    return np.stack(low, -1), np.stack(high, -1)


def build(
    tissue: Tissue = ALIAGA2022, progress: Callable[[int, int], None] | None = None
) -> SpectralTable:
    """Solves transport exactly at every node (212 544 cases, seconds on two cores).

    `progress(done, total)` is called after each wavelength.
    """
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
            dermis_scattering=float(tissue.scattering(WAVELENGTHS)[i]) * tissue.dermis_scattering,
        )

    nodes = np.empty((len(WAVELENGTHS), *NODES))
    with ThreadPoolExecutor() as pool:
        for i, solved in enumerate(pool.map(solve, range(len(WAVELENGTHS)))):
            nodes[i] = solved
            if progress:
                progress(i + 1, len(WAVELENGTHS))
    return _finish(tissue, nodes)


def _finish(tissue: Tissue, nodes: NDArray[np.float64]) -> SpectralTable:
    coefficients = nodes
    for axis in range(3):
        matrix = chebyshev_to_spline(NODES[axis], CELLS[axis])
        coefficients = np.moveaxis(
            np.tensordot(matrix, coefficients, axes=(1, axis + 1)), 0, axis + 1
        )
    low, high = axis_ranges(tissue)
    return SpectralTable(
        tissue, nodes, np.ascontiguousarray(coefficients, dtype=np.float32), low, high
    )


def save(table: SpectralTable, file: str | IO[bytes]) -> None:
    """Writes the nodes and the tissue's constants as .npz, without pickle."""
    constants = np.array(json.dumps(asdict(table.tissue)))
    np.savez_compressed(file, nodes=table.nodes.astype(np.float32), tissue=constants)


def load(file: str | IO[bytes]) -> SpectralTable:
    """Reads what `save` wrote."""
    with np.load(file, allow_pickle=False) as stored:
        tissue = Tissue(**json.loads(str(stored["tissue"])))
        return _finish(tissue, stored["nodes"].astype(np.float64))


def table_file(tissue: Tissue) -> str:
    """The name that the table of a tissue ships under."""
    return f"{tissue.name}{'-rare' if tissue.rare_chromophores else ''}.npz"


def spectral_table(tissue: Tissue = ALIAGA2022) -> SpectralTable:
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


def chebyshev(count: int) -> NDArray[np.float64]:
    """(count,) Chebyshev points of [0, 1], ends included."""
    return (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2


def _chebyshev_values(x: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """(len(x), count) matrix from values at Chebyshev points to values at x, barycentric."""
    sign = (-1.0) ** np.arange(count)
    sign[[0, -1]] *= 0.5
    gap = x[:, None] - chebyshev(count)
    at_node = np.abs(gap) < 1e-14
    matrix = sign / np.where(at_node, 1.0, gap)
    matrix /= matrix.sum(axis=1, keepdims=True)
    return np.where(np.any(at_node, axis=1, keepdims=True), at_node, matrix)


@lru_cache(maxsize=16)
def chebyshev_to_spline(count: int, cells: int, degree: int = 3) -> NDArray[np.float64]:
    """(cells + degree, count) least-squares matrix from Chebyshev values to B-splines of [0, 1]."""
    x = np.linspace(0.0, 1.0, 8 * cells + 1)
    return np.linalg.pinv(spline_basis(x, cells, degree)) @ _chebyshev_values(x, count)


def spline_basis(x: NDArray[np.float64], cells: int, degree: int = 3) -> NDArray[np.float64]:
    """(len(x), cells + degree) values of the uniform B-splines at x; the end's beyond [0, 1]."""
    from scipy.interpolate import BSpline

    knots = (np.arange(cells + 2 * degree + 1) - degree) / cells
    inside = np.clip(x, 0.0, 1.0)
    return BSpline.design_matrix(inside, knots, degree, extrapolate=True).toarray()
