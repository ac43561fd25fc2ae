"""Cells of tables: numbers as instruments print them, and texts that a spreadsheet must not run."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.textures.problem import problem, shorten

EMPTY = {"", "nan", "na", "n/a", "null", "-", "--", "none"}
"""What stands for a value that is not there, in lower case."""
_NUMBER = re.compile(
    r"([+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e[+-]?\d+)?)\s*([^\d\s.,+-]{0,12})", re.I
)
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


@dataclass(frozen=True)
class Numbers:
    """Values of cells, NaN where they are empty, and the unit that stands behind all of them."""

    values: NDArray[np.float64]
    unit: str = ""


def is_number(text: str) -> bool:
    """Whether a cell holds a number, with or without a unit behind it."""
    return _NUMBER.fullmatch(text) is not None


def is_empty(text: str) -> bool:
    """Whether a cell stands for no value."""
    return text.lower() in EMPTY


def numbers(
    path: Path, cells: Sequence[str], place: Callable[[int], str], decimal_comma: bool
) -> Numbers:
    """The numbers in a column of cells; `place(i)` says in words where cell i stands.

    With `decimal_comma` a comma may be the decimal mark, in all cells of the column or in none.
    Raises CutisError, naming the place, for a cell that holds something else, another decimal mark
    or another unit than the cells above it.
    """
    try:
        plain = np.array(cells, dtype=np.float64)
        if np.isfinite(plain).all() and not any("_" in cell for cell in cells):
            return Numbers(plain)
    except ValueError:
        pass
    values = np.full(len(cells), np.nan)
    mark, unit = "", None
    for i, text in enumerate(cells):
        if is_empty(text):
            continue
        found = _NUMBER.fullmatch(text)
        if found is None or ("," in found[1] and not decimal_comma):
            raise problem(path, f"{place(i)} is '{shorten(text)}', not a number")
        own = next((c for c in found[1] if c in ".,"), "")
        if own and mark and own != mark:
            what = f"with '{own}' where cells above have '{mark}'"
            raise problem(path, f"{place(i)} is '{shorten(text)}', {what}")
        if unit is not None and found[2] != unit:
            what = f"in '{found[2]}' where cells above are in '{unit}'"
            raise problem(path, f"{place(i)} is '{shorten(text)}', {what}")
        mark, unit = mark or own, found[2]
        values[i] = float(found[1].replace(",", "."))
        if not np.isfinite(values[i]):
            raise problem(path, f"{place(i)} is '{shorten(text)}', too large a number")
    return Numbers(values, unit or "")


def text_cell(text: str) -> str:
    """A text as a cell that no spreadsheet takes for a formula; numbers stay as they are.

    Texts that begin with =, +, -, @, a tab or a return get an apostrophe in front.
    """
    if text.startswith(_FORMULA) and not is_number(text):
        return f"'{text}"
    return text
