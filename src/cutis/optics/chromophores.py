"""Absorption of the substances that colour skin.

Every function takes wavelengths in nm (any shape) and returns a natural-log absorption
coefficient in cm⁻¹ of the *pure* substance at the stated concentration, same shape, float64.
Tabulated substances are interpolated linearly and may be asked for 250–1000 nm (haemoglobin), 380–
800 nm (methaemoglobin) or from 250 nm up (bilirubin and β-carotene, which do not absorb past
700 nm); outside, they raise.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.optics.tables import packaged_table

LN10 = float(np.log(10.0))
"""Turns a decadic (molar extinction) coefficient into a natural-log absorption coefficient."""

HEMOGLOBIN_MOLAR_MASS = 64500.0
"""g/mol, tetramer [prahl1999hemoglobin]."""
HEMOGLOBIN_TABLES = ("prahl1999", "bosschaart2014", "bosschaart2014-prahl1999")
"""Molar extinction of haemoglobin in solution [prahl1999hemoglobin], 250–1000 nm, and whole blood
averaged over the literature [bosschaart2014], 380–1000 nm. The first absorbs a quarter more at
620 nm, and 60 % more at 450 nm, where there is no oxygen. The third is the second, but oxygenated
haemoglobin is the first's below 480 nm, where averages of dense blood flatten the Soret band; they
agree within 4 % at 470 to 490 nm and are blended there."""
SORET_PEAK, SORET_WAVELENGTH = 4 * 179e3, 405.0
"""cm⁻¹/(mol/L) and nm: highest extinction of methaemoglobin [antonini1971]."""
SORET_WIDTH = 762.5
"""cm⁻¹, standard deviation of the band with which methaemoglobin goes on below 450 nm: the one that
has the table's slope there."""
YELLOW_ENDS = 550.0
"""nm from which the tables of bilirubin and β-carotene are noise and drift, 0.1 and 0.5 % of their
peaks: nothing in the concentrations of healthy skin, a dent in those of the rare parameters."""
WHOLE_BLOOD = 150.0
"""g/L of haemoglobin in the blood of bosschaart2014 (haematocrit 45 %)."""
BILIRUBIN_MOLAR_MASS = 584.66
"""g/mol [aliaga2022, appendix]."""
BETA_CAROTENE_MOLAR_MASS = 536.8726
"""g/mol [aliaga2022, appendix]."""


def _interpolate(
    name: str, column: str, wavelength: ArrayLike, zero_past_end: bool
) -> NDArray[np.float64]:
    table = packaged_table("chromophores", name)
    nodes, values = (
        table["lambda_nm"],
        np.maximum(table[column], 0.0),
    )  # noise around zero is not gain
    lam = np.asarray(wavelength, dtype=np.float64)
    if lam.size and (lam.min() < nodes[0] or (lam.max() > nodes[-1] and not zero_past_end)):
        raise CutisError(
            f"{name}: wavelengths {lam.min():g}-{lam.max():g} nm are outside the table "
            f"({nodes[0]:g}-{nodes[-1]:g} nm); choose wavelengths in nm inside it"
        )
    return np.interp(lam, nodes, values, right=0.0 if zero_past_end else None)


def eumelanin(
    wavelength: ArrayLike, scale: float = 6.6e11, power: float = -3.33
) -> NDArray[np.float64]:
    """Eumelanin in the melanosome, scale · λ^power cm⁻¹ [donner2006, after jacques1991]."""
    return scale * np.asarray(wavelength, dtype=np.float64) ** power


def pheomelanin(
    wavelength: ArrayLike, scale: float = 2.9e15, power: float = -4.75
) -> NDArray[np.float64]:
    """Pheomelanin in the melanosome, scale · λ^power cm⁻¹ [donner2006, after sarna2006]."""
    return scale * np.asarray(wavelength, dtype=np.float64) ** power


def baseline(
    wavelength: ArrayLike, scale: float = 7.84e8, power: float = -3.255
) -> NDArray[np.float64]:
    """Bloodless, melanin-free tissue, scale · λ^power cm⁻¹ [saidi1992]."""
    return scale * np.asarray(wavelength, dtype=np.float64) ** power


def baseline_jacques(
    wavelength: ArrayLike, offset: float = 0.244, scale: float = 85.3
) -> NDArray[np.float64]:
    """Bloodless, melanin-free skin, offset + scale · exp(−(λ − 154) / 66.2) cm⁻¹ [jacques1998]."""
    lam = np.asarray(wavelength, dtype=np.float64)
    return offset + scale * np.exp(-(lam - 154.0) / 66.2)


def oxyhemoglobin(
    wavelength: ArrayLike, concentration: float = 150.0, table: str = "prahl1999"
) -> NDArray[np.float64]:
    """Oxygenated haemoglobin at `concentration` g/L of blood, by one of HEMOGLOBIN_TABLES."""
    return _hemoglobin("HbO2", "mua_oxy", wavelength, concentration, table)


def deoxyhemoglobin(
    wavelength: ArrayLike, concentration: float = 150.0, table: str = "prahl1999"
) -> NDArray[np.float64]:
    """Deoxygenated haemoglobin at `concentration` g/L of blood, by one of HEMOGLOBIN_TABLES."""
    return _hemoglobin("Hb", "mua_deoxy", wavelength, concentration, table)


def _hemoglobin(
    molar: str, whole: str, wavelength: ArrayLike, concentration: float, table: str
) -> NDArray[np.float64]:
    if table == "prahl1999":
        moles = concentration / HEMOGLOBIN_MOLAR_MASS
        return LN10 * moles * _interpolate("hemoglobin_prahl", molar, wavelength, False)
    per_mm = _interpolate("blood_bosschaart", whole, wavelength, zero_past_end=False)
    blood = 10 * per_mm * (concentration / WHOLE_BLOOD)
    if table == "bosschaart2014" or molar == "Hb":
        return blood
    dissolved = _hemoglobin(molar, whole, wavelength, concentration, "prahl1999")
    share = np.clip((490.0 - np.asarray(wavelength, dtype=np.float64)) / 20.0, 0.0, 1.0)
    return blood + share * (dissolved - blood)


def methemoglobin(wavelength: ArrayLike, concentration: float = 150.0) -> NDArray[np.float64]:
    """Methaemoglobin at `concentration` g/L of blood [zijlstra2000], 450–800 nm, solution.

    The table ends at 450 nm. From there to 380 nm it goes on as a constant and a Gaussian band in
    wavenumber with the published peak, which meet value and slope of the table: this project's
    extension, not a measurement.
    """
    lam = np.asarray(wavelength, dtype=np.float64)
    if lam.size and lam.min() < 380:
        raise CutisError(
            f"methaemoglobin is known for 380-800 nm, not {lam.min():g} nm; choose others"
        )
    first = packaged_table("chromophores", "methemoglobin_zijlstra")["lambda_nm"][0]
    measured = np.maximum(lam, first)
    molar = _interpolate("methemoglobin_zijlstra", "Hi", measured, zero_past_end=False)
    end, at_end = _soret(first), _interpolate("methemoglobin_zijlstra", "Hi", first, False)
    rest = (at_end - SORET_PEAK * end) / (1 - end)
    molar = np.where(lam < first, rest + (SORET_PEAK - rest) * _soret(lam), molar)
    return LN10 * (concentration / HEMOGLOBIN_MOLAR_MASS) * molar


def _soret(wavelength: ArrayLike) -> NDArray[np.float64]:
    """The band of height 1."""
    lam = np.asarray(wavelength, dtype=np.float64)
    away = (1e7 / lam - 1e7 / SORET_WAVELENGTH) / SORET_WIDTH  # nm → cm⁻¹
    return np.exp(-0.5 * away**2)


def bilirubin(
    wavelength: ArrayLike, concentration: float = 0.05, last: float = np.inf
) -> NDArray[np.float64]:
    """Bilirubin at `concentration` g/L, extinction in chloroform [photochemcad]; 0 past `last`."""
    moles = concentration / BILIRUBIN_MOLAR_MASS
    return LN10 * moles * _until(last, "bilirubin_chloroform", wavelength)


def beta_carotene(
    wavelength: ArrayLike, concentration: float = 2.1e-4, last: float = np.inf
) -> NDArray[np.float64]:
    """β-carotene at `concentration` g/L, extinction in hexane [photochemcad]; 0 past `last`."""
    moles = concentration / BETA_CAROTENE_MOLAR_MASS
    return LN10 * moles * _until(last, "beta_carotene_hexane", wavelength)


def _until(last: float, name: str, wavelength: ArrayLike) -> NDArray[np.float64]:
    molar = _interpolate(name, "epsilon", wavelength, zero_past_end=True)
    return np.where(np.asarray(wavelength) > last, 0.0, molar) if last < np.inf else molar
