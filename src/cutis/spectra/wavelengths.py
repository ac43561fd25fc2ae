"""Lists of wavelengths beside cubes that do not say theirs."""

import os
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.spectra.cells import is_number, numbers
from cutis.spectra.reflectance import nanometres
from cutis.spectra.stored import load_numbers
from cutis.textures.problem import problem
from cutis.textures.regular import read_regular

LONGEST = 16 << 20
"""Bytes of such a list."""
_SPLIT = re.compile(r"[;,\t ]+")


def read_wavelengths(path: str | os.PathLike[str]) -> tuple[NDArray[np.float64], list[str]]:
    """Wavelengths, nm, of a .npy file or of a text file with numbers in its first column.

    Raises CutisError, one line that names the file, where it holds something else.
    """
    path = Path(path)
    if path.suffix.lower() == ".npy":
        return nanometres(path, np.ravel(load_numbers(path)))
    instead = "is no list of wavelengths; write them one a line, in nm"
    try:
        text = read_regular(path, LONGEST).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise problem(path, "is no text in UTF-8; give wavelengths one a line") from None
    lines = [line.strip() for line in text.splitlines() if line.strip() and line[:1] != "#"]
    rows = [[cell for cell in _SPLIT.split(line) if cell] for line in lines]
    if len(rows) == 1:
        cells = rows[0]
    else:
        cells = [row[0] for row in rows if row]
        cells = cells[1:] if cells and not is_number(cells[0]) else cells
    if not cells or not all(is_number(cell) for cell in cells):
        raise problem(path, instead)
    found = numbers(path, cells, lambda i: f"number {i + 1}", False)
    return nanometres(path, found.values, found.unit)
