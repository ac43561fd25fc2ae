"""The CIE 1931 2° observer and the CIE illuminants, every 5 nm from 380 to 780 nm [cie15]."""

from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError


@cache
def _columns(name: str) -> dict[str, NDArray[np.float64]]:
    text = resources.files("cutis.data").joinpath("colour", f"{name}.csv").read_text("utf-8")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    table = np.array([[float(cell) for cell in row.split(",")] for row in lines[1:]]).T
    table.flags.writeable = False
    return dict(zip(lines[0].split(","), table, strict=True))


def wavelengths() -> NDArray[np.float64]:
    """(81,) nm, those of `colour_matching` and `illuminant`."""
    return _columns("cie1931_2deg")["lambda_nm"]


def colour_matching() -> NDArray[np.float64]:
    """(81, 3) colour-matching functions x̄, ȳ, z̄."""
    table = _columns("cie1931_2deg")
    return np.stack([table["x"], table["y"], table["z"]], axis=-1)


def illuminant(name: str) -> NDArray[np.float64]:
    """(81,) relative spectral power of the CIE illuminant `name` (A, D65, FL11, LED-B3, …)."""
    table = _columns("illuminants")
    for known, power in table.items():
        if known.lower() == name.lower() and known != "lambda_nm":
            return power
    known_names = ", ".join(key for key in table if key != "lambda_nm")
    raise CutisError(f"unknown illuminant {name!r}; known are {known_names}")
