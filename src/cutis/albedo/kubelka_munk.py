"""Skin by Kubelka–Munk in the manner of Alotaibi and Smith: two parameters, a baseline.

An epidermis that only absorbs, passed twice (Lambert–Beer), over a dermis of two diffuse fluxes:
R = exp(−2 μa,e t) · R∞(K, S) [alotaibi2017]. Chromophores and scattering are those of a tissue;
melanin and blood are free, all else is held.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.colour import spectrum_to_rgb
from cutis.errors import CutisError
from cutis.optics import WAVELENGTHS, Tissue
from cutis.optics.parameters import BLOOD, EUMELANIN, MELANIN, OXYGENATION, THICKNESS
from cutis.transport.kubelka_munk import CONVERSIONS, coefficients, half_space, layer, over

EPIDERMES = ("absorbing", "scattering")


@dataclass(frozen=True)
class KubelkaMunkSkin:
    """The two-parameter skin; what is held is as in the code published with [alotaibi2019].

    `epidermis` "absorbing" is theirs; "scattering" is a layer of two fluxes too, with the tissue's
    μs′. `melanin` and `blood` are ranges as (low, high), `thickness` is in µm. Raises CutisError
    for values outside the ranges of `optics.PARAMETERS`, and unknown names.
    """

    tissue: Tissue
    conversion: str = "gate1974"
    epidermis: str = "absorbing"
    thickness: float = 200.0
    eumelanin: float = 0.61
    oxygenation: float = 0.75
    melanin: tuple[float, float] = (0.001, 0.43)
    blood: tuple[float, float] = (0.001, 0.07)

    def __post_init__(self) -> None:
        for value, known in ((self.conversion, CONVERSIONS), (self.epidermis, EPIDERMES)):
            if value not in known:
                raise CutisError(f"Kubelka–Munk skin: choose {', '.join(known)}, not {value!r}")
        for parameter in (THICKNESS, EUMELANIN, OXYGENATION):
            parameter.check(getattr(self, parameter.name))
        for parameter in (MELANIN, BLOOD):
            low, high = getattr(self, parameter.name)
            if not parameter.check(low) < parameter.check(high):
                raise CutisError(
                    f"the range of {parameter.name} must rise, not {low:g} to {high:g}"
                )

    def reflectance(self, melanin: ArrayLike, blood: ArrayLike) -> NDArray[np.float64]:
        """Melanin and blood volume fractions (...) → (..., 41) at `optics.WAVELENGTHS`.

        Raises CutisError for fractions outside 0 to 1.
        """
        for name, share in (("melanin", melanin), ("blood", blood)):
            values = np.asarray(share)
            if not np.all((values >= 0) & (values <= 1)):  # also catches NaN
                raise CutisError(f"{name} is a volume fraction: it must lie in 0 to 1")
        lam = WAVELENGTHS
        above = self.tissue.epidermis_absorption(melanin, self.eumelanin, lam)
        below = self.tissue.dermis_absorption(blood, self.oxygenation, lam)
        reduced = self.tissue.reduced_scattering(lam)
        depth = self.thickness * 1e-4  # cm
        under = self.tissue.dermis_reduced_scattering(lam, self.eumelanin)
        dermis = half_space(*coefficients(below, under, self.conversion))
        if self.epidermis == "absorbing":
            return np.asarray(np.exp(-2.0 * above * depth) * dermis)
        return over(*layer(*coefficients(above, reduced, self.conversion), depth), dermis)

    def rgb(self, melanin: ArrayLike, blood: ArrayLike) -> NDArray[np.float64]:
        """The same as (..., 3) linear sRGB under D65."""
        return self.reflectance(melanin, blood) @ spectrum_to_rgb(WAVELENGTHS)
