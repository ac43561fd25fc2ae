"""How far light goes in the medium that a renderer walks in: its mean free path per RGB band.

A homogeneous medium stands for the layers. Its single-scattering albedo follows from the diffuse
albedo (`inversion`); its lengths follow from the tissue. By similarity, to leading order as
absorption vanishes, media of equal reduced scattering μs′ = (1 − g) μs spread light alike, so that
the mean free path of a walk with anisotropy g is (1 − g) times that of an isotropic one: 1/μs′ at
g = 0.

Bands are linear sRGB of the lengths as if they were a reflectance under D65, with its negative
lobes: distances scale with the mean free path, and RGB is linear in the spectrum of what arrives
at a distance. Cut at 0, the weights would make red a tenth too narrow. What comes out is put back
into the range of the spectrum. `of_maps` adds what the dermis absorbs, 1 / (μs′ + μa): light
spreads there, while the epidermis, thinner than a mean free path, filters what goes through and
spreads it little, so that melanin leaves the mean free path as it is.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import map_coordinates

from cutis.colour.spectra import spectrum_to_rgb
from cutis.maps import SkinMaps
from cutis.optics import WAVELENGTHS, Tissue

MM_PER_CM = 10.0
"""Millimetres in a centimetre: a coefficient in cm⁻¹ is a length of 10 mm over it."""
BLOOD, OXYGENATION, TYPE = 65, 17, 9
"""Nodes of the table over blood (equal steps of its fourth root), oxygenation and, where the dermis
scatters by it, the share of eumelanin."""
SHARE = 0.3
"""Share of eumelanin where no map says it: about the median of measured skins."""


def mean_free_path(tissue: Tissue, anisotropy: float = 0.0) -> NDArray[np.float64]:
    """(3,) mean free path in mm of red, green and blue, from the dermis' reduced scattering.

    `anisotropy` is the g that the renderer walks with.
    """
    scattering = tissue.dermis_reduced_scattering(WAVELENGTHS, SHARE)
    return (1 - anisotropy) * _bands(MM_PER_CM / scattering)


def mean_free_path_in(
    tissue: Tissue,
    blood: ArrayLike,
    oxygenation: ArrayLike,
    anisotropy: float = 0.0,
    eumelanin: ArrayLike = SHARE,
) -> NDArray[np.float64]:
    """(..., 3) the same in mm with the absorption of a dermis of `blood`, `oxygenation` (...).

    The share of `eumelanin` (...) counts where the tissue's dermis scatters by it.
    """
    scattering = tissue.dermis_reduced_scattering(WAVELENGTHS, eumelanin)
    absorption = tissue.dermis_absorption(blood, oxygenation, WAVELENGTHS)
    return (1 - anisotropy) * _bands(MM_PER_CM / (scattering + absorption))


def of_maps(skin: SkinMaps, anisotropy: float = 0.0) -> NDArray[np.float32]:
    """(H, W, 3) `mean_free_path_in` of every texel, from a table; off the mask `mean_free_path`."""
    table = _table(skin.tissue)
    place = np.stack([
        np.clip(skin.eumelanin, 0, 1) * (table.shape[1] - 1),
        np.sqrt(np.sqrt(np.clip(skin.blood, 0, 1))) * (BLOOD - 1),
        np.clip(skin.oxygenation, 0, 1) * (OXYGENATION - 1),
    ])  # fmt: skip
    found = np.empty((*skin.shape, 3), np.float32)
    for band in range(3):
        map_coordinates(table[band], place, found[..., band], order=1, mode="nearest")
    found *= np.float32(1 - anisotropy)
    found[skin.mask <= 0] = mean_free_path(skin.tissue, anisotropy)
    return found


def _bands(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 41) lengths → (..., 3) of red, green and blue."""
    low, high = lengths.min(axis=-1, keepdims=True), lengths.max(axis=-1, keepdims=True)
    return np.clip(lengths @ spectrum_to_rgb(WAVELENGTHS), low, high)


@lru_cache(maxsize=8)
def _table(tissue: Tissue) -> NDArray[np.float64]:
    """(3, TYPE or 1, BLOOD, OXYGENATION) isotropic mean free paths in mm."""
    share, blood, oxygenation = np.meshgrid(
        np.linspace(0, 1, TYPE if tissue.dermis_by_type else 1),
        np.linspace(0, 1, BLOOD) ** 4,
        np.linspace(0, 1, OXYGENATION),
        indexing="ij",
    )
    return np.moveaxis(mean_free_path_in(tissue, blood, oxygenation, 0.0, share), -1, 0)
