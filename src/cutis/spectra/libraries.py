"""ENVI spectral libraries read as the tables that they are; which files are tables."""

from pathlib import Path

import numpy as np

from cutis.errors import CutisError
from cutis.spectra.envi import EnviHeader
from cutis.spectra.table_files import SUFFIXES, SpectraFile, read_spectra, sorted_spectra
from cutis.textures.problem import problem

_LIBRARIES = (".sli", ".hdr", ".lib")


def is_table(path: Path) -> bool:
    """Whether a file is a table of spectra rather than a cube, by its name and an ENVI header."""
    suffix = path.suffix.lower()
    if suffix in SUFFIXES or suffix not in _LIBRARIES:
        return suffix in SUFFIXES
    try:
        return EnviHeader(path).library
    except CutisError:
        return suffix == ".sli"


def open_table(path: Path) -> SpectraFile:
    """The spectra of a text file or of an ENVI spectral library, named by header or values.

    Raises CutisError as `read_spectra` does.
    """
    return _read_library(path) if path.suffix.lower() in _LIBRARIES else read_spectra(path)


def _read_library(path: Path) -> SpectraFile:
    header = EnviHeader(path)
    file, (count, samples, bands), _ = header.open()
    with file:
        if bands != 1:
            raise problem(header.path, f"is a library of {bands} bands; repair the header")
        values = file.rows(slice(None)).reshape(count, samples).astype(np.float64)
    wavelengths, notes = header.wavelengths()
    if len(wavelengths) != samples:
        what = f"{len(wavelengths)} wavelengths are given for spectra of {samples} values"
        raise problem(header.path, f"{what}; repair the header")
    ignored = header.number("data ignore value")
    if ignored is not None:
        values[values == ignored] = np.nan
    values[~np.isfinite(values)] = np.nan
    scale = header.number("reflectance scale factor")
    names = header.listed("spectra names")
    names += [str(i) for i in range(len(names) + 1, count + 1)]
    return sorted_spectra(
        SpectraFile(
            path, ["spectrum"], [[name] for name in names[:count]], wavelengths, values, notes,
            np.zeros(count, dtype=bool), stored_one=scale if scale and scale > 0 else None,
        )
    )  # fmt: skip
