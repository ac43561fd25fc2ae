"""Cells: numbers as they are printed, and texts that no spreadsheet runs."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.spectra import text_cell
from cutis.spectra.cells import is_number, numbers

PATH = Path("a.csv")


def read(*cells, comma=False):
    return numbers(PATH, cells, lambda i: f"cell {i}", comma)


@pytest.mark.parametrize(
    ("cells", "values", "unit"),
    [
        (("1", "2.5", "-3e-1"), [1, 2.5, -0.3], ""),
        (("1", "", "nan", "-", "N/A"), [1, np.nan, np.nan, np.nan, np.nan], ""),
        (("400 nm", "410nm"), [400, 410], "nm"),
        (("45.5 %", "40 %"), [45.5, 40], "%"),
        ((".5", "5."), [0.5, 5], ""),
    ],
)
def test_numbers(cells, values, unit):
    found = read(*cells)
    np.testing.assert_array_equal(found.values, values)
    assert found.unit == unit


def test_decimal_commas_where_no_comma_splits():
    np.testing.assert_array_equal(read("0,5", "1,25", "2", comma=True).values, [0.5, 1.25, 2])
    for cells in (("0,5", "0.5"), ("0.5", "0,5"), ("1,234.5",), ("1.234,5",)):
        with pytest.raises(CutisError, match=r"^a\.csv: cell \d is"):
            read(*cells, comma=True)
    with pytest.raises(CutisError, match="not a number"):
        read("0,5")


@pytest.mark.parametrize("text", ["bright", "0x10", "1_0", "inf", "1 2", "1e999", "--5", "5 nm x"])
def test_what_is_no_number(text):
    with pytest.raises(CutisError, match=r"cell 1 is '"):
        read("1.5", text, comma=True)
    assert not is_number("bright")


@pytest.mark.parametrize(
    "text",
    ["=1+cmd|x", "+1+1", "-2+3", "@SUM(A1)", "\t=1", "\r=1", '=HYPERLINK("http://x")', "-arm"],
)
def test_formulas_become_text(text):
    cell = text_cell(text)
    assert cell == f"'{text}"
    assert text_cell(cell) == cell
    held = io.StringIO()
    csv.writer(held).writerow([cell])
    assert not held.getvalue().lstrip('"').startswith(("=", "+", "-", "@", "\t", "\r"))


@pytest.mark.parametrize("text", ["arm", "", "-0.5", "+3", "1e-3", "#1 arm", "'quoted", "λ"])
def test_other_cells_stay(text):
    assert text_cell(text) == text
