"""Tables of measured spectra: CSV, a column or a row for each spectrum."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError

WAVELENGTH = re.compile(r"^(wave)?_?(length|lambda|nm|wl)?[ _]*(\[?\(?nm\)?\]?)?$", re.IGNORECASE)
"""Names of a column of wavelengths: wavelength_nm, lambda_nm, nm, Wavelength (nm), …"""
NUMBER = re.compile(r"^[A-Za-z_ ]{0,3}(\d{2,4}(?:\.\d+)?)\s*(?:nm)?$")
"""Names of columns that are wavelengths: 400, 400.5, 400nm, R400, …"""


@dataclass(frozen=True, eq=False)
class SpectraTable:
    """Spectra (n, m) at `wavelengths` (m,), NaN where a cell is empty, and what names them.

    `labels` names the columns of `cells` (n rows), which are carried over: those that are no
    wavelengths, or `spectrum`, the name of the column that the spectrum was in.
    """

    wavelengths: NDArray[np.float64]
    spectra: NDArray[np.float64]
    labels: tuple[str, ...]
    cells: tuple[tuple[str, ...], ...]


def read_spectra(path: Path) -> SpectraTable:
    """Spectra of a CSV: a column each beside one of wavelengths, or a row each under wavelengths.

    Lines that begin with # are left out. Raises CutisError, one line, for what is no such table.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = (line for line in file if line.strip() and not line.startswith("#"))
            header, *table = list(csv.reader(lines)) or [[]]
    except FileNotFoundError:
        raise CutisError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise CutisError(f"{path} is a folder; give a CSV of spectra") from None
    except (UnicodeDecodeError, csv.Error):
        raise CutisError(f"{path.name}: not a CSV file in UTF-8") from None
    header = [name.strip() for name in header]
    if not table or len(header) < 2:
        raise CutisError(f"{path.name}: needs a header and at least one spectrum")
    for number, cells in enumerate(table, 1):
        if len(cells) != len(header):
            raise CutisError(
                f"{path.name}, row {number}: {len(cells)} cells under {len(header)} columns"
            )
    if header[0] and WAVELENGTH.match(header[0]):
        return _columns(path, header, table)
    found = [(i, match) for i, name in enumerate(header) if (match := NUMBER.match(name))]
    if len(found) < 2:
        raise CutisError(
            f"{path.name}: its first column is not wavelength_nm, nor are wavelengths (400, 410, "
            "…) among its columns"
        )
    places = [i for i, _ in found]
    at = np.array([float(match[1]) for _, match in found])
    order = np.argsort(at)
    others = [i for i in range(len(header)) if i not in places]
    spectra = np.array([[_number(path, n, cells[i]) for i in places]
                        for n, cells in enumerate(table, 1)])  # fmt: skip
    return SpectraTable(
        at[order], spectra[:, order], tuple(header[i] for i in others),
        tuple(tuple(cells[i] for i in others) for cells in table),
    )  # fmt: skip


def _columns(path: Path, header: list[str], table: list[list[str]]) -> SpectraTable:
    values = np.array(
        [[_number(path, n, cell) for cell in cells] for n, cells in enumerate(table, 1)]
    )
    at = values[:, 0]
    if not np.isfinite(at).all():
        raise CutisError(f"{path.name}: a wavelength is missing")
    order = np.argsort(at, kind="stable")
    names = tuple((name,) for name in header[1:])
    return SpectraTable(at[order], values[order, 1:].T.copy(), ("spectrum",), names)


def _number(path: Path, row: int, cell: str) -> float:
    text = cell.strip()
    if not text or text.lower() in ("nan", "na", "n/a", "-"):
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise CutisError(f"{path.name}, row {row}: {text[:40]!r} is not a number") from None
