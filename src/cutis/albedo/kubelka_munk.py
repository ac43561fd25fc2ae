"""Skin by Kubelka–Munk in the manner of Alotaibi and Smith: two parameters, a baseline.

An epidermis that only absorbs, passed twice (Lambert–Beer), over a dermis of two diffuse fluxes:
R = exp(−2 μa,e t) · R∞(K, S) [alotaibi2017]. Chromophores and scattering are those of a tissue;
melanin and blood are free, all else is held.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour import spectrum_to_rgb
from cutis.optics import ALIAGA2022, WAVELENGTHS, Tissue
from cutis.transport.kubelka_munk import coefficients, half_space


@dataclass(frozen=True)
class KubelkaMunkSkin:
    """The two-parameter skin; what is held is as in the authors' published code.

    `melanin` and `blood` are their ranges as (low, high); `thickness` in µm.
    """

    tissue: Tissue = ALIAGA2022
    conversion: str = "gate1974"
    thickness: float = 200.0
    eumelanin: float = 0.61
    oxygenation: float = 0.75
    melanin: tuple[float, float] = (0.001, 0.43)
    blood: tuple[float, float] = (0.001, 0.07)

    def reflectance(self, melanin: ArrayLike, blood: ArrayLike) -> NDArray[np.float64]:
        """Melanin and blood volume fractions (...) → (..., 41) at `optics.WAVELENGTHS`."""
        lam = WAVELENGTHS
        epidermis = self.tissue.epidermis_absorption(melanin, self.eumelanin, lam)
        dermis = self.tissue.dermis_absorption(blood, self.oxygenation, lam)
        k, s = coefficients(dermis, self.tissue.reduced_scattering(lam), self.conversion)
        return np.exp(-2.0 * epidermis * self.thickness * 1e-4) * half_space(k, s)

    def rgb(self, melanin: ArrayLike, blood: ArrayLike) -> NDArray[np.float64]:
        """The same as (..., 3) linear sRGB under D65."""
        return self.reflectance(melanin, blood) @ spectrum_to_rgb(WAVELENGTHS)
