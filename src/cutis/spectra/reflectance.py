"""Numbers from spectral files, in whatever unit they come, as nm and fractions.

What is unambiguous is converted and said in a note; what is not is refused.
"""

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError
from cutis.textures.problem import problem, shorten

HIGHEST = 1.2
"""Reflectance above which a value is no skin: left out, like one below 0."""
_FRACTION, _PERCENT = 1.5, 130.0
_UNITS = {
    **dict.fromkeys(("nm", "nanometer", "nanometre"), 1.0),
    **dict.fromkeys(("um", "µm", "μm", "micrometer", "micrometre", "micron"), 1e3),
    **dict.fromkeys(("å", "a", "angstrom", "ångström", "angström"), 0.1),
    **dict.fromkeys(("m", "meter", "metre"), 1e9),
}
_MOST_NAMED = 3


def nanometres(
    path: str | os.PathLike[str], values: ArrayLike, unit: str | None = None
) -> tuple[NDArray[np.float64], list[str]]:
    """Wavelengths (n,) in nm, with notes. `unit` is what the file calls theirs, if it does.

    In the singular or plural, with or without braces. Without a unit, wavelengths all below 10 are
    taken for micrometres.
    """
    found = np.asarray(values, dtype=np.float64)
    if not found.size or not (np.isfinite(found).all() and (found > 0).all()):
        raise problem(path, "some wavelengths are missing or not above 0; repair the list")
    unit = (unit or "").strip("{}[]() \t").lower()
    if unit in ("", "unknown", "none"):
        if found.max() < 10:
            return found * 1e3, ["wavelengths are below 10: taken for micrometres"]
        return found, []
    factor = _UNITS.get(unit, _UNITS.get(unit.removesuffix("s")))
    if factor is None:
        what = f"wavelengths in {shorten(unit)} are not known; give a list in nm by --wavelengths"
        raise problem(path, what)
    if factor == 1 and found.max() < 10:
        return found * 1e3, ["wavelengths are below 10, not in nm: taken for micrometres"]
    return found * factor, []


def fraction_scale(
    path: str | os.PathLike[str], sample: ArrayLike, scale: float | None = None
) -> tuple[float, list[str]]:
    """What stored values are to be multiplied by to be fractions, with notes.

    `sample` are values of the file, any shape, NaN allowed; `scale` the stored value that means 1
    where that is known. Values are percent where the largest of the sample's spectra say so and
    they are no whole numbers, which may be counts of any number of bits.
    """
    if scale is not None:
        return 1 / _given(scale), []
    values = _positive(sample)
    if not values.size:
        raise problem(path, "has no value above 0; export its reflectance again")
    factor, doubt = _guess(values)
    if doubt:
        raise problem(path, doubt)
    return factor, [] if factor == 1 else [f"values of up to {_top(values)}: taken for percent"]


def spectrum_scales(
    path: Path,
    values: NDArray[np.float64],
    scale: float | None,
    percent: NDArray[np.bool_],
    names: Sequence[str],
) -> tuple[NDArray[np.float64], list[str]]:
    """(n,) the same for each spectrum of (n, w) values of a table, with notes.

    `percent` (n,) are those of which the table says so; `names` say which is which, for people.
    """
    if scale is not None:
        return np.full(len(values), 1 / _given(scale)), []
    if not _positive(values).size:
        raise problem(path, "has no value above 0; export its reflectance again")
    found = np.full(len(values), np.nan)
    guessed: list[int] = []
    for i, row in enumerate(values):
        positive = _positive(row)
        if not positive.size:
            continue
        found[i], doubt = _guess(positive, bool(percent[i]))
        if doubt:
            raise problem(path, f"{names[i]}: {doubt}")
        if not percent[i] and found[i] != 1:
            guessed.append(i)
    notes = ["in percent, as the table says"] if percent.any() else []
    if guessed:
        rest = bool((found == 1).any())
        listed = ", ".join(names[i] for i in guessed[:_MOST_NAMED])
        which = f" ({listed}{', …' if len(guessed) > _MOST_NAMED else ''})" if rest else ""
        top = _top(np.concatenate([_positive(values[i]) for i in guessed]))
        notes.append(f"values of up to {top}: taken for percent{which}")
    found[np.isnan(found)] = 1.0
    return found, notes


def _guess(values: NDArray[np.float64], percent: bool = False) -> tuple[float, str]:
    """What values above 0 are to be multiplied by, and why that cannot be told, "" if it can.

    `percent` says that the file calls them so.
    """
    top = float(np.percentile(values, 95))
    if top <= _FRACTION:
        what = "is said to be percent, but looks like fractions"
        return 1.0, f"{what}; give the value that means 1: --scale 1" if percent else ""
    if top > _PERCENT:
        what = f"values of up to {top:.4g} are neither fractions nor percent"
        return 1.0, f"{what}; give the value that means 1: --scale 10000, say"
    if not percent and (values == np.rint(values)).all():
        what = f"whole numbers of up to {values.max():.4g} are percent or counts"
        return 0.01, f"{what}; give the value that means 1: --scale 100, or --scale 255"
    return 0.01, ""


def _top(values: NDArray[np.float64]) -> str:
    return f"{float(np.percentile(values, 95)):.3g}"


def _given(scale: float) -> float:
    if not (np.isfinite(scale) and scale > 0):
        raise CutisError(f"scale = {scale:g}: it is the stored value that means 1, above 0")
    return scale


def _positive(values: ArrayLike) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64)
    return found[np.isfinite(found) & (found > 0)]


def without_impossible(
    spectra: NDArray[np.floating],
) -> tuple[NDArray[np.float32], int, int]:
    """Fractions (..., n) with NaN for those below 0 or above HIGHEST; how many of each."""
    found = np.array(spectra, dtype=np.float32)
    with np.errstate(invalid="ignore"):
        low, high = found < 0, found > HIGHEST
    found[low | high | np.isinf(found)] = np.nan
    return found, int(low.sum()), int(high.sum())
