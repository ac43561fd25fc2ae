"""The CIE 1931 2° observer and lights by name or file, every 5 nm from 380 to 780 nm [cie15]."""

import difflib
import re
from pathlib import Path
from typing import Protocol

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


class Spectrum(Protocol):
    """A light that was read already (`light.Light`)."""

    @property
    def power(self) -> NDArray[np.float64]:
        """(81,) relative spectral power."""


LightLike = str | Spectrum
"""A name or file that `illuminant` takes, or a light that was read."""


def illuminant(name: LightLike) -> NDArray[np.float64]:
    """(81,) relative spectral power of a light.

    `name` is a CIE illuminant in either case (A, D65, FL11 or F11, FL3.5, HP1, LED-B3, …), a CIE
    daylight of another temperature (D93: 9300 K), D65-prime (also D65'), or a file that
    `read_light` takes.
    Raises CutisError for anything else. A `Light` gives its power.
    """
    if not isinstance(name, str):
        return name.power
    plain = name.strip().lower()
    plain = re.sub(r"^f(?=\d)", "fl", plain)
    plain = "d65-prime" if plain in ("d65'", "d65′", "d65prime") else plain
    for table in ("illuminants", "d65_prime"):
        for known, power in packaged_table("colour", table).items():
            if known.lower() == plain and known != "lambda_nm":
                return power
    if re.fullmatch(r"d(\d\d|\d{4,5})", plain):
        return _daylight(float(plain[1:]) * (100.0 if len(plain) == 3 else 1.0))
    if Path(name).suffix.lower() in (".csv", ".txt", ".spd") or Path(name).is_file():
        return read_light(name)
    near = difflib.get_close_matches(plain, [known.lower() for known in illuminant_names()], 3, 0.5)
    hint = f"is it {' or '.join(n.upper() for n in near)}? else " if near else ""
    raise CutisError(
        f"unknown illuminant {name!r}; {hint}take a CIE name (A, D65, FL11, LED-B3), D65-prime, or "
        "a CSV file with the columns wavelength_nm,power"
    )


def illuminant_names() -> list[str]:
    """The lights that are tabulated."""
    tables = (packaged_table("colour", name) for name in ("illuminants", "d65_prime"))
    return [name for table in tables for name in table if name != "lambda_nm"]


def _daylight(temperature: float) -> NDArray[np.float64]:
    """CIE daylight of a nominal correlated colour temperature, 4000 to 25 000 K [cie15]."""
    if not 4000 <= temperature <= 25000:
        raise CutisError(f"CIE daylight is defined from D40 to D250, not at {temperature:g} K")
    from colour.colorimetry import sd_CIE_illuminant_D_series
    from colour.temperature import CCT_to_xy_CIE_D

    chromaticity = CCT_to_xy_CIE_D(temperature * 1.4388 / 1.4380)  # c₂ has changed since 1931
    series = sd_CIE_illuminant_D_series(chromaticity, M1_M2_rounding=False)
    return np.interp(wavelengths(), series.wavelengths, series.values)


GAP = 20.0
"""nm, the widest step that a spectral file may take between 400 and 700 nm."""


def read_light(path: str | Path) -> NDArray[np.float64]:
    """(81,) relative power from a text file with a row per wavelength: nm and power.

    Separated by commas, semicolons, tabs or blanks; lines that begin with # and one header line are
    left out. Between rows the spectrum is linear; before the first and after the last it is 0.
    Raises CutisError, naming the file, unless the rows increase in wavelength, cover 400 to 700 nm
    without gaps above GAP, and are finite, not negative and not all zero.
    """
    path = Path(path)
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except FileNotFoundError:
        raise CutisError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError):
        raise CutisError(f"{path.name}: not a text file of wavelength and power") from None
    rows: list[list[float]] = []
    lines = [line.strip() for line in lines]
    lines = [line for line in lines if line and not line.startswith("#")]
    for number, line in enumerate(lines):
        cells = [cell for cell in re.split(r"[,;\s]+", line) if cell]
        try:
            rows.append([float(cell) for cell in cells])
        except ValueError:
            if number:
                raise CutisError(
                    f"{path.name}: {line[:40]!r} is not wavelength and power"
                ) from None
    if len(rows) < 2 or any(len(row) != 2 for row in rows):
        raise CutisError(
            f"{path.name}: needs rows of wavelength in nm and relative power, two numbers each "
            "with points for decimals"
        )
    lam, power = np.array(rows).T
    if not (np.isfinite(lam).all() and np.all(np.diff(lam) > 0)):
        raise CutisError(f"{path.name}: its wavelengths must be in nm and increase")
    inside = np.concatenate([[400.0], lam[(lam > 400) & (lam < 700)], [700.0]])
    if lam[0] > 400 or lam[-1] < 700 or np.diff(inside).max() > GAP:
        raise CutisError(
            f"{path.name}: its spectrum has gaps; it must cover 400 to 700 nm in steps of at most "
            f"{GAP:g} nm"
        )
    if not (np.isfinite(power).all() and power.min() >= 0 and power.max() > 0):
        raise CutisError(f"{path.name}: its power must be finite, not negative and not all zero")
    return np.interp(wavelengths(), lam, power, left=0.0, right=0.0)
