"""Numbers from spectral files, in whatever unit they come, as nm and fractions.

What is unambiguous is converted and said in a note; what is not is refused.
"""

import csv
import os
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.textures.problem import problem, shorten

HIGHEST = 1.2
"""Reflectance above which a value is no skin: left out, like one below 0."""
_FRACTION, _PERCENT = 1.5, 130.0
_UNITS = {
    "nanometers": 1.0, "nanometres": 1.0, "nm": 1.0,
    "micrometers": 1e3, "micrometres": 1e3, "microns": 1e3, "um": 1e3, "µm": 1e3, "μm": 1e3,
}  # fmt: skip


def nanometres(
    path: str | os.PathLike[str], values: ArrayLike, unit: str | None = None
) -> tuple[NDArray[np.float64], list[str]]:
    """Wavelengths (n,) in nm, with notes. `unit` is what the file calls theirs, if it does.

    Without a unit, wavelengths all below 10 are taken for micrometres.
    """
    found = np.asarray(values, dtype=np.float64)
    if not found.size or not (np.isfinite(found).all() and (found > 0).all()):
        raise problem(path, "some wavelengths are missing or not above 0; repair the list")
    unit = (unit or "").strip().lower()
    if unit in ("", "unknown"):
        if found.max() < 10:
            return found * 1e3, ["wavelengths are below 10: taken for micrometres"]
        return found, []
    if unit not in _UNITS:
        what = f"wavelengths in {shorten(unit)} are not known; give a list in nm by --wavelengths"
        raise problem(path, what)
    return found * _UNITS[unit], []


def fraction_scale(
    path: str | os.PathLike[str], sample: ArrayLike, scale: float | None = None
) -> tuple[float, list[str]]:
    """What stored values are to be multiplied by to be fractions, with notes.

    `sample` are values of the file, any shape, NaN allowed; `scale` the stored value that means 1
    where that is known. Values are percent where the largest of the sample's spectra say so.
    """
    if scale is not None:
        if not (np.isfinite(scale) and scale > 0):
            raise CutisError(f"scale = {scale:g}: it is the stored value that means 1, above 0")
        return 1 / scale, []
    values = np.asarray(sample, dtype=np.float64)
    values = values[np.isfinite(values) & (values > 0)]
    if not values.size:
        raise problem(path, "has no value above 0; export its reflectance again")
    top = float(np.percentile(values, 95))
    if top <= _FRACTION:
        return 1.0, []
    if top <= _PERCENT:
        return 0.01, [f"values of up to {top:.3g}: taken for percent"]
    what = f"values of up to {top:.4g} are neither fractions nor percent"
    raise problem(path, f"{what}; give the value that means 1: --scale 10000, say")


def without_impossible(
    spectra: NDArray[np.floating],
) -> tuple[NDArray[np.float32], int, int]:
    """Fractions (..., n) with NaN for those below 0 or above HIGHEST; how many of each."""
    found = np.array(spectra, dtype=np.float32)
    with np.errstate(invalid="ignore"):
        low, high = found < 0, found > HIGHEST
    found[low | high | np.isinf(found)] = np.nan
    return found, int(low.sum()), int(high.sum())


def read_wavelengths(path: str | os.PathLike[str]) -> tuple[NDArray[np.float64], list[str]]:
    """Wavelengths, nm, of a .npy file or of a text file with numbers in its first column."""
    path = Path(path)
    if not path.is_file():
        raise problem(path, "no such file; give the list of wavelengths")
    if path.suffix.lower() == ".npy":
        return nanometres(path, np.ravel(load_array(path)))
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise problem(path, "is no text in UTF-8; give wavelengths one a line") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    try:
        rows = [[c for c in row if c.strip()] for row in csv.reader(lines)]
        if len(rows) == 1:
            return nanometres(path, [float(cell) for cell in rows[0]])
        first = 0 if rows and _is_number(rows[0][0]) else 1
        return nanometres(path, [float(row[0]) for row in rows[first:]])
    except (ValueError, IndexError, csv.Error):
        raise problem(path, "is no list of wavelengths; write them one a line, in nm") from None


def load_array(path: Path) -> NDArray[np.generic]:
    """A .npy file of numbers, mapped, not read; CutisError where it is something else."""
    try:
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise problem(path, "is no NumPy array of numbers; save it again by numpy.save") from error
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fui":
        raise problem(path, "is no NumPy array of real numbers; save it again by numpy.save")
    return array


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
