"""Tables of spectra: CSV with a column per spectrum, or with a row per spectrum, told apart."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.spectra.reflectance import nanometres
from cutis.textures.problem import problem, shorten

AXIS = {
    "wavelength",
    "wavelength_nm",
    "lambda",
    "lambda_nm",
    "nm",
    "wl",
    "λ",
    "λ_nm",
    "wavelengths",
}
"""Names, in lower case, of the column of wavelengths where spectra are columns."""
_BAND = re.compile(r"(?:[a-zλ]{1,12}[_ .]?)?(\d+(?:\.\d+)?)(?: ?_?(nm|µm|um))?", re.IGNORECASE)
_EMPTY = {"", "nan", "na", "n/a", "null", "-", "none"}


@dataclass(frozen=True, eq=False)
class SpectraFile:
    """`values` (n, w) as stored at `wavelengths` (w,), nm, NaN where a cell is empty.

    `columns` and `labels` (n lists) are what else the table says of each spectrum.
    """

    columns: list[str]
    labels: list[list[str]]
    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    notes: list[str]


def read_spectra(path: Path) -> SpectraFile:
    """The spectra of a CSV file: comma, semicolon or tab; lines with # are comments.

    Spectra are columns where the first column is called wavelength_nm (or λ, nm, …); they are rows
    where at least three columns are called by wavelengths (400, R_400, 400 nm). CutisError, one
    line that names the file and the cell, for anything else.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise CutisError(f"{path}: no such file") from None
    except UnicodeDecodeError:
        raise problem(path, "is no CSV file in UTF-8; export it again as CSV") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise problem(path, "is empty; a header and spectra are needed")
    delimiter = max(",;\t", key=lines[0].count)
    try:
        header, *table = list(csv.reader(lines, delimiter=delimiter, strict=True))
    except csv.Error as error:
        raise problem(path, f"is no CSV file ({error}); export it again") from None
    header = [name.strip() for name in header]
    for number, row in enumerate(table, 1):
        if len(row) != len(header):
            raise problem(path, f"row {number} has {len(row)} cells under {len(header)} columns")
    if not table:
        raise problem(path, "has a header, but no rows; a row per spectrum or wavelength is needed")
    decimal = "," if delimiter == ";" else "."
    first = re.sub(r"[\s_(\[\])]+", "_", header[0].lower()).strip("_")
    if first in AXIS or (first in ("", "x") and len(header) > 1):
        return _columns(path, header, table, decimal)
    return _rows(path, header, table, decimal)


def _columns(path: Path, header: list[str], table: list[list[str]], decimal: str) -> SpectraFile:
    if len(header) < 2:
        raise problem(path, "has wavelengths, but no column of reflectance beside them")
    cells = np.array(
        [
            [
                _number(path, cell, decimal, f"row {i}, column {header[j]}")
                for j, cell in enumerate(r)
            ]
            for i, r in enumerate(table, 1)
        ]
    )
    wavelengths, notes = nanometres(path, cells[:, 0])
    names = [name or str(i) for i, name in enumerate(header[1:], 1)]
    return _sorted(
        path, ["spectrum"], [[name] for name in names], wavelengths, cells[:, 1:].T, notes
    )


def _rows(path: Path, header: list[str], table: list[list[str]], decimal: str) -> SpectraFile:
    found = {i: m for i, name in enumerate(header) if (m := _BAND.fullmatch(name)) is not None}
    if len(found) < 3:
        listed = shorten(", ".join(header[:6]))
        raise problem(
            path,
            f"no spectra in columns {listed}: call the first column wavelength_nm, "
            "or columns by their wavelengths",
        )
    units = {(m[2] or "").lower() for m in found.values()} - {""}
    wavelengths, notes = nanometres(
        path, [float(m[1]) for m in found.values()], units.pop() if units else None
    )
    values = np.array(
        [
            [_number(path, row[i], decimal, f"row {number}, column {header[i]}") for i in found]
            for number, row in enumerate(table, 1)
        ]
    )
    others = [i for i in range(len(header)) if i not in found]
    labels = [[row[i] for i in others] for row in table]
    columns = [header[i] for i in others]
    if not others:
        columns, labels = ["spectrum"], [[str(i)] for i in range(1, len(table) + 1)]
    return _sorted(path, columns, labels, wavelengths, values, notes)


def _sorted(
    path: Path, columns: list[str], labels: list[list[str]], wavelengths: NDArray[np.float64],
    values: NDArray[np.float64], notes: list[str],
) -> SpectraFile:  # fmt: skip
    order = np.argsort(wavelengths, kind="stable")
    if (np.diff(wavelengths[order]) == 0).any():
        twice = wavelengths[order][1:][np.diff(wavelengths[order]) == 0][0]
        raise problem(path, f"says {twice:g} nm twice; leave one of them out")
    return SpectraFile(
        columns, labels, wavelengths[order], np.ascontiguousarray(values[:, order]), notes
    )


def _number(path: Path, text: str, decimal: str, where: str) -> float:
    text = text.strip()
    if text.lower() in _EMPTY:
        return float("nan")
    try:
        return float(text.replace(",", ".") if decimal == "," else text)
    except ValueError:
        raise problem(path, f"{where} is {shorten(text)!r}, not a number") from None
