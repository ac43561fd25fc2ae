"""Tables of spectra: a column per spectrum, or a row per spectrum, told apart.

What stands about the table is left out and counted: lines in front and behind, comments, units.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.spectra import sheets
from cutis.spectra.cells import Numbers, is_empty, is_number, numbers
from cutis.spectra.reflectance import nanometres, spectrum_scales
from cutis.spectra.sheets import DELIMITERS, SAMPLE, LeftOut, Row
from cutis.spectra.table_layout import Layout, are_units, axis_unit, locate, unit_of
from cutis.textures.problem import problem, shorten

SUFFIXES = (".csv", ".tsv", ".txt")
"""What tables of text are usually called, lower case."""


@dataclass(frozen=True, eq=False)
class SpectraFile:
    """`values` (n, w) as stored at `wavelengths` (w,), nm, NaN where a cell is empty.

    `columns` and `labels` (n lists) are what else the table says of each spectrum, `percent` (n,)
    whether it says that a spectrum is in percent, `lines` (n) on which line a spectrum stands, none
    where spectra are columns, `stored_one` the value that means 1 where the file says so. `notes`
    say what was left out or assumed.
    """

    path: Path
    columns: list[str]
    labels: list[list[str]]
    wavelengths: NDArray[np.float64]
    values: NDArray[np.float64]
    notes: list[str]
    percent: NDArray[np.bool_]
    lines: list[int] = field(default_factory=list)
    stored_one: float | None = None

    def scale(
        self, inside: NDArray[np.bool_], given: float | None = None
    ) -> tuple[NDArray[np.float64], list[str]]:
        """(n, 1) what values are to be multiplied by to be fractions, and notes.

        `inside` (w,) are the wavelengths that count, `given` the stored value that means 1 where
        that is known. Raises CutisError where values are neither fractions nor percent, are whole
        numbers that may be counts, and where rows disagree.
        """
        if given is None and self.stored_one is not None:
            factor = np.full((len(self.values), 1), 1 / self.stored_one)
            return factor, [f"the header says that {self.stored_one:g} means 1"]
        names = [shorten("/".join(cell for cell in label if cell)) for label in self.labels]
        if self.lines:
            names = [f"line {n}: {name}" for n, name in zip(self.lines, names, strict=True)]
        values = self.values[:, inside]
        found, notes = spectrum_scales(self.path, values, given, self.percent, names)
        kinds, counts = np.unique(found[np.isfinite(values).any(axis=1)], return_counts=True)
        if self.lines and given is None and len(kinds) > 1:
            odd = kinds[np.argmin(counts)]
            one, other = ("fractions", "percent") if odd == 1 else ("percent", "fractions")
            raise problem(
                self.path,
                f"{names[int(np.argmax(found == odd))]} looks like {one}, others like {other}; "
                "give the value that means 1: --scale 100, or --scale 1",
            )
        return found[:, None], notes


def read_spectra(path: Path) -> SpectraFile:
    """The spectra of a text file: comma, semicolon, tab or spaces between its cells.

    Spectra are columns where the first column is called wavelength (or λ, nm, …) or where there are
    only numbers; they are rows where at least three columns are called by wavelengths (400, R_400,
    SPECTRAL_NM_400, 400[nm]). CutisError, one line that names file, line and cell, for anything
    else.
    """
    text = sheets.read_text(path)
    if not any(line.strip("# \t") for line in text.splitlines() if not line.startswith("#")):
        raise problem(path, "is empty; a header and spectra are needed")
    if "BEGIN_DATA_FORMAT" in text:
        return _cgats(path, text)
    delimiter, text = sheets.separator(text)
    delimiter = delimiter or _delimiter(path, text)
    return _table(path, sheets.rows(path, text, delimiter), delimiter != ",")


def _delimiter(path: Path, text: str) -> str:
    """What splits the most numbers apart in a table; where there is none, what is most frequent."""
    sample = "\n".join(text.splitlines()[:SAMPLE])
    scores: dict[str, tuple[int, int]] = {}
    failures: list[CutisError] = []
    for delimiter in DELIMITERS:
        try:
            rows = sheets.rows(path, sample, delimiter)
        except CutisError as error:
            failures.append(error)
            continue
        layout = locate(rows)
        count = 0
        for row in rows[layout.start :] if layout is not None else ():
            cells = row.trimmed()
            fits = len(cells) <= len(layout.header) if layout is not None else False
            good = [c for c in cells if is_number(c) and (delimiter != "," or "," not in c)]
            count += len(good) if fits and len(good) > 1 else 0
        scores[delimiter] = count, sample.count(delimiter) if delimiter != " " else 0
    if not scores or (failures and max(scores.values())[0] == 0):
        raise failures[0]
    return max(scores, key=lambda one: scores[one])


def _table(path: Path, rows: list[Row], decimal_comma: bool) -> SpectraFile:
    if not rows:
        raise problem(path, "is empty; a header and spectra are needed")
    layout = locate(rows)
    left = LeftOut()
    if layout is None:
        first = next((row for row in rows if not row.cells[0].startswith("#")), rows[0])
        listed = shorten(", ".join(first.cells[:6]))
        raise problem(
            path,
            f"no spectra in columns {listed}: call the first column wavelength_nm, "
            "or columns by their wavelengths",
        )
    for row in rows[: max(0, layout.start - bool(any(layout.header)))]:
        left.add(row)
    body, units = _body(path, rows[layout.start :], layout, left)
    if not body:
        raise problem(path, "has a header, but no rows; a row per spectrum or wavelength is needed")
    read = _columns if layout.form == "columns" else _rows
    return read(path, layout, body, units, decimal_comma, left)


def _body(
    path: Path, rows: Sequence[Row], layout: Layout, left: LeftOut
) -> tuple[list[Row], list[str]]:
    """Rows of the table, all as long as its header, and the cells of a row of units."""
    width = len(layout.header)
    body: list[Row] = []
    units: list[str] = []
    values = [band.column for band in layout.bands] or range(1, width)
    for row in rows:
        cells = row.trimmed()
        numeric = sum(is_number(cells[i]) for i in values if i < len(cells))
        if cells[0].startswith("#") and (len(cells) != width or not numeric):
            left.add(row)
        elif not body and not units and are_units(cells):
            units = cells
            left.notes.append(f"line {row.line} is taken for units")
        elif len(cells) > width:
            what = f"has {len(cells)} cells under {width} columns"
            raise problem(path, f"line {row.line}: row {len(body) + 1} {what}")
        elif len(row.cells) == 1 and not is_number(cells[0]) and not is_empty(cells[0]):
            left.add(row)  # such as the end that an instrument marks
        elif cells == layout.header and len(cells) > 1:
            raise problem(path, f"line {row.line}: another table begins; keep one in each file")
        elif len(row.cells) < width:
            what = f"has {len(row.cells)} cells under {width} columns"
            raise problem(path, f"line {row.line}: row {len(body) + 1} {what}")
        else:
            body.append(Row(row.line, [*cells, *[""] * (width - len(cells))]))
    return body, units


def _columns(
    path: Path, layout: Layout, body: list[Row], units: list[str], comma: bool, left: LeftOut
) -> SpectraFile:
    header = list(layout.header)
    while (
        len(header) > 1 and not header[-1] and not any(row.cells[len(header) - 1] for row in body)
    ):
        header.pop()
    if len(header) < 2:
        raise problem(path, "has wavelengths, but no column of reflectance beside them")
    columns = [_column(path, body, j, name or str(j + 1), comma) for j, name in enumerate(header)]
    units = [*units, *[""] * (len(header) - len(units))]
    unit = columns[0].unit or axis_unit(header[0]) or unit_of(units[0])
    wavelengths, notes = nanometres(path, columns[0].values, unit)
    if not any(header):
        notes.append("there is no header: the first column is taken for wavelengths")
    percent = [
        "%" in f"{column.unit}{name}{said}"
        for column, name, said in zip(columns[1:], header[1:], units[1:], strict=True)
    ]
    names = [name or str(i) for i, name in enumerate(header[1:], 1)]
    if len(header) == 2 and not header[1]:
        names = [path.stem]
    return sorted_spectra(
        SpectraFile(
            path, ["spectrum"], [[name] for name in names], wavelengths,
            np.stack([column.values for column in columns[1:]]), [*left.note(), *notes],
            np.array(percent),
        )
    )  # fmt: skip


def _rows(
    path: Path, layout: Layout, body: list[Row], units: list[str], comma: bool, left: LeftOut
) -> SpectraFile:
    if len(layout.kinds) > 1:
        listed = shorten(" and ".join(kind or "without a name" for kind in layout.kinds))
        raise problem(path, f"has columns of several kinds at each wavelength ({listed}); keep one")
    bands = layout.bands
    said = {band.unit for band in bands} | {unit_of(unit) for unit in units}
    said -= {""}
    if len(said) > 1:
        raise problem(path, f"gives wavelengths in {' and '.join(sorted(said))}; keep one unit")
    unit = said.pop() if said else None
    wavelengths, notes = nanometres(path, [band.value for band in bands], unit)
    columns = [_column(path, body, b.column, layout.header[b.column], comma) for b in bands]
    percent = "%" in units or any(
        band.percent or column.unit == "%" for band, column in zip(bands, columns, strict=True)
    )
    used = {band.column for band in bands}
    others = [
        j
        for j, name in enumerate(layout.header)
        if j not in used and (name or any(row.cells[j] for row in body))
    ]
    labels = [[row.cells[j] for j in others] for row in body]
    names = [layout.header[j] for j in others]
    if not others:
        names, labels = ["spectrum"], [[str(i)] for i in range(1, len(body) + 1)]
    return sorted_spectra(
        SpectraFile(
            path, names, labels, wavelengths, np.stack([c.values for c in columns], axis=1),
            [*left.note(), *notes], np.full(len(body), percent), [row.line for row in body],
        )
    )  # fmt: skip


def _column(path: Path, body: Sequence[Row], column: int, name: str, comma: bool) -> Numbers:
    """The numbers of one column of the table."""

    def place(i: int) -> str:
        return f"line {body[i].line}: row {i + 1}, column {shorten(name)}"

    return numbers(path, [row.cells[column] for row in body], place, comma)


def _cgats(path: Path, text: str) -> SpectraFile:
    """The first table of a CGATS file [cgats]: its fields are the header."""
    lines = text.splitlines()
    begin, end = _between(path, lines, "DATA_FORMAT", 0)
    header = [
        cell for row in sheets.rows(path, "\n".join(lines[begin:end]), " ") for cell in row.cells
    ]
    if not header:
        raise problem(
            path, "is CGATS without fields between its marks of DATA_FORMAT; export it again"
        )
    first, last = _between(path, lines, "DATA", end)
    found = sheets.rows(path, "\n".join(lines[first:last]), " ")
    body = [Row(row.line + first, row.cells) for row in found]
    read = _table(path, [Row(begin + 1, header), *body], False)
    more = text.count("BEGIN_DATA_FORMAT") - 1
    if more:
        read.notes.append(f"the first of {more + 1} tables is read")
    return read


def _between(path: Path, lines: Sequence[str], name: str, start: int) -> tuple[int, int]:
    """First line and the one behind the last between BEGIN_ and END_."""
    marks = [re.compile(rf"\s*{mark}_{name}\s*$") for mark in ("BEGIN", "END")]
    places = []
    for mark in marks:
        at = next((i for i in range(start, len(lines)) if mark.match(lines[i])), None)
        if at is None:
            raise problem(path, f"is CGATS whose {name} is not whole; export it again")
        places.append(at)
        start = at + 1
    return places[0] + 1, places[1]


def sorted_spectra(found: SpectraFile) -> SpectraFile:
    """The same in the order of wavelengths; CutisError where one comes twice."""
    order = np.argsort(found.wavelengths, kind="stable")
    ascending = found.wavelengths[order]
    if (np.diff(ascending) == 0).any():
        twice = ascending[1:][np.diff(ascending) == 0][0]
        raise problem(found.path, f"says {twice:g} nm twice; leave one of them out")
    values = np.ascontiguousarray(found.values[:, order])
    return replace(found, wavelengths=ascending, values=values)
