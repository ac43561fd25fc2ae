"""The spectral table as eight products per wavelength, which is what is evaluated.

At one wavelength, the albedo as a matrix over (epidermis absorption, thickness) and dermis
absorption is of low rank: what the dermis sends up passes the epidermis, and little goes around
more than twice. Eight terms carry it to 3e-7, so that 4 · 4 + 4 nodes of eight lanes replace
4 · 4 · 4 nodes:

    albedo(e, d, t) = Σ_r upper_r(e, t) · lower_r(d).
"""

import numpy as np
from numpy.typing import NDArray

from cutis.albedo.spectral_table import CELLS, NODES, SpectralTable, to_splines

TERMS = 8
"""Products per wavelength: the lanes of a vector."""


def separate(table: SpectralTable) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """B-spline coefficients `upper` (41, E+3, T+3, 8) and `lower` (41, D+3, 8); 50 ms."""
    by_dermis = np.moveaxis(table.nodes, 2, 3).astype(np.float64)
    bands, *rest, dermis = by_dermis.shape
    left, sizes, right = np.linalg.svd(by_dermis.reshape(bands, -1, dermis), full_matrices=False)
    share = np.sqrt(sizes[:, None, :TERMS])
    upper = (left[..., :TERMS] * share).reshape(bands, *rest, TERMS)
    lower = np.swapaxes(right, 1, 2)[..., :TERMS] * share
    over_e, over_d, over_t = map(to_splines, NODES, CELLS)
    upper = np.einsum("xe,yt,betr->bxyr", over_e, over_t, upper, optimize=True)
    lower = np.einsum("xd,bdr->bxr", over_d, lower)
    return np.ascontiguousarray(upper, np.float32), np.ascontiguousarray(lower, np.float32)
