"""The CIE 1931 2° observer and the CIE illuminants, every 5 nm from 380 to 780 nm [cie15]."""

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.optics.tables import packaged_table


def wavelengths() -> NDArray[np.float64]:
    """(81,) nm, those of `colour_matching` and `illuminant`."""
    return packaged_table("colour", "cie1931_2deg")["lambda_nm"]


def colour_matching() -> NDArray[np.float64]:
    """(81, 3) colour-matching functions x̄, ȳ, z̄."""
    table = packaged_table("colour", "cie1931_2deg")
    return np.stack([table["x"], table["y"], table["z"]], axis=-1)


def illuminant(name: str) -> NDArray[np.float64]:
    """(81,) relative spectral power of the CIE illuminant `name` (A, D65, FL11, LED-B3, …)."""
    table = packaged_table("colour", "illuminants")
    for known, power in table.items():
        if known.lower() == name.lower() and known != "lambda_nm":
            return power
    known_names = ", ".join(key for key in table if key != "lambda_nm")
    raise CutisError(f"unknown illuminant {name!r}; known are {known_names}")
