"""Text of instruments and spreadsheets as rows of cells, each with its line in the file."""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from cutis.textures.problem import problem
from cutis.textures.regular import read_regular

LONGEST = 256 << 20
"""Bytes of a table; 100 000 spectra of 41 bands take 40 MB."""
DELIMITERS = ("\t", ";", ",", "|", " ")
"""What may stand between cells; a space stands for any number of them."""
SAMPLE = 400
"""Lines that show what the delimiter is."""
_WORDS = re.compile(r'"([^"]*)"|(\S+)')
_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)


@dataclass(frozen=True)
class Row:
    """Cells of a row, without spaces about them, and its line, counted from 1."""

    line: int
    cells: list[str]

    @property
    def empty(self) -> bool:
        """Whether no cell holds anything."""
        return not any(self.cells)

    def trimmed(self) -> list[str]:
        """The cells up to the last that holds something."""
        count = len(self.cells)
        while count and not self.cells[count - 1]:
            count -= 1
        return self.cells[:count]


@dataclass
class LeftOut:
    """Lines that are no rows of the table, with how one begins."""

    lines: list[int] = field(default_factory=list)
    first: str = ""
    notes: list[str] = field(default_factory=list)
    """What to say of other lines."""

    def add(self, row: Row) -> None:
        """One more."""
        self.first = self.first or " ".join(row.cells)[:40].strip()
        self.lines.append(row.line)

    def note(self) -> list[str]:
        """What to say of them."""
        if not self.lines:
            return self.notes
        count = len(self.lines)
        what = "1 line is" if count == 1 else f"{count} lines are"
        where = f"{_ranges(self.lines)}: {self.first} …"
        return [f"{what} no part of the table and left out ({where})", *self.notes]


def _ranges(numbers: list[int], most: int = 5) -> str:
    """1-3, 7, 9 and so on."""
    parts: list[list[int]] = []
    for number in sorted(numbers):
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    shown = [f"{a}" if a == b else f"{a}-{b}" for a, b in parts[:most]]
    return "line " * (len(numbers) == 1) + ", ".join(shown) + ", …" * (len(parts) > most)


def read_text(path: Path) -> str:
    """The text of a table in UTF-8, with or without a byte order mark.

    Raises CutisError for a file that is missing, no regular file, too long or no such text.
    """
    try:
        return read_regular(path, LONGEST).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise problem(path, "is no CSV file in UTF-8; export it again as CSV") from None


def separator(text: str) -> tuple[str | None, str]:
    """The delimiter that a first line sep=; names, and the text with that line blank."""
    first, newline, rest = text.partition("\n")
    named = _SEPARATOR.fullmatch(first.strip().strip('"'))
    return (named[1], newline + rest) if named else (None, text)


def rows(path: Path, text: str, delimiter: str) -> list[Row]:
    """The rows of a text, those that hold something.

    Raises CutisError where quotes do not fit.
    """
    return [row for row in _rows(path, text.splitlines(), delimiter) if not row.empty]


def _rows(path: Path, lines: list[str], delimiter: str) -> Iterator[Row]:
    if delimiter == " ":
        for number, line in enumerate(lines, 1):
            yield Row(number, [quoted or plain for quoted, plain in _WORDS.findall(line)])
        return
    reader = csv.reader(lines, delimiter=delimiter, strict=True)
    first = 1
    try:
        for cells in reader:
            yield Row(first, [cell.strip() for cell in cells])
            first = reader.line_num + 1
    except csv.Error as error:
        raise problem(path, f"line {first}: is no CSV ({error}); export it again") from None
