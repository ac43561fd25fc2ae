"""Where in a sheet the table of spectra is, and what its columns are."""

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from cutis.spectra.cells import is_number
from cutis.spectra.sheets import SAMPLE, Row

AXIS = {
    *("wavelength", "wavelengths", "lambda", "wl", "λ", "nm", "wave", "nanometers", "nanometer"),
    *("wellenlänge", "wellenlaenge"),
}
"""First words, in lower case, of the column of wavelengths where spectra are columns."""
UNITS = {
    "nm", "nanometer", "nanometers", "nanometre", "nanometres", "um", "µm", "μm", "micrometer",
    "micrometers", "micrometre", "micrometres", "micron", "microns", "å", "a", "angstrom",
    "angstroms",
}  # fmt: skip
_FEWEST = 3
_SHORTEST = 200.0  # nm; smaller numbers behind a name are those of samples
_MICROMETRES = 0.2, 3.0  # that stand alone
_NAME = re.compile(r"(\D{0,24}?)(\d+(?:[.,]\d+)?)(\D{0,16})")
_WORD = re.compile(r"[^\W\d_]+")


@dataclass(frozen=True)
class Band:
    """A column of values at one wavelength, as its name says it; "" for what it does not say."""

    column: int
    kind: str
    value: float
    unit: str
    percent: bool


@dataclass(frozen=True)
class Layout:
    """A table that begins behind row `start`, with the cells of its header.

    "columns": a column per spectrum beside wavelengths. "rows": a row per spectrum under `bands`.
    """

    form: Literal["columns", "rows"]
    header: list[str]
    start: int
    bands: tuple[Band, ...] = ()
    kinds: tuple[str, ...] = ()


def locate(rows: Sequence[Row]) -> Layout | None:
    """The table in a sheet; None where there is none.

    Its header is the first row that calls its first cell wavelengths, with numbers under it, or the
    one with most wavelengths in it. It may begin with a mark of comment, as NumPy writes it, or be
    missing where rows are nothing but numbers.
    """
    axis: Layout | None = None
    named: Layout | None = None
    bare: Layout | None = None
    doubtful: Layout | None = None
    for i, row in enumerate(rows[:SAMPLE]):
        cells = row.trimmed()
        header = [cells[0].lstrip("#").strip(), *cells[1:]]
        commented = cells[0].startswith("#")
        bands, kinds = named_bands(header)
        if named is None or len(bands) > len(named.bands):
            all_numbers = len(bands) == len(header) and max(b.value for b in bands) < 10
            if len(bands) >= _FEWEST and not (all_numbers and _is_bare(rows[i:])):
                named = Layout("rows", header, i + 1, bands, kinds)
        if axis is None and _is_axis(header) and not (commented and len(header) < 2):
            found = Layout("columns", header, i + 1)
            under = [r.trimmed() for r in rows[i + 1 : i + 3]]
            under = under[1:] if under and are_units(under[0]) else under[:1]
            if under and is_number(under[0][0]) and len(bands) < len(header) - 1:
                axis = found
            elif not commented:
                doubtful = doubtful or found
        headed = i > 0 and len(rows[i - 1].trimmed()) == len(cells)
        if bare is None and not headed and _is_bare(rows[i:]):
            bare = Layout("columns", [""] * len(cells), i)
        if bare is not None or axis is not None:
            break  # what comes next are its rows
    candidates = [layout for layout in (axis, named, bare) if layout is not None]
    return min(candidates, key=lambda layout: layout.start) if candidates else doubtful


def axis_unit(name: str) -> str | None:
    """The unit in the name of the column of wavelengths, "" for none; None of other names."""
    words = [word.lower() for word in _WORD.findall(name)]
    if not words or words[0] not in AXIS:
        return None
    units = [word for word in words if word in UNITS]
    others = [word for word in words[1:] if word not in UNITS and word != "in"]
    return None if others else (units[0] if units else "")


def unit_of(word: str) -> str:
    """A unit of wavelengths, in lower case and without brackets; "" for other words."""
    bare = word.strip("[](){} ").lower()
    return bare if bare in UNITS else ""


def are_units(cells: Sequence[str]) -> bool:
    """Whether a row under the header says units: nm, 1, %."""
    words = [cell for cell in cells if cell]
    good = all(unit_of(word) or word.strip("[]()") in ("1", "%", "-", "a.u.") for word in words)
    return good and any(unit_of(word) or "%" in word for word in words)


def _is_axis(header: list[str]) -> bool:
    if axis_unit(header[0]) is not None:
        return True
    unnamed = header[0].lower() in ("", "x") and len(header) > 1
    return unnamed and not any(is_number(name) for name in header[1:])


def _is_bare(rows: Sequence[Row]) -> bool:
    """Whether rows without a header are wavelengths, which rise or fall, and values."""
    first = [row.trimmed() for row in rows[:_FEWEST]]
    if len(first) < _FEWEST or any(len(cells) < 2 for cells in first):
        return False
    if not all(is_number(cell) for cells in first for cell in cells[:2]):
        return False
    axis = [_value(cells[0]) for cells in first]
    steps = [b - a for a, b in itertools.pairwise(axis)]
    return min(axis) >= 0.1 and (min(steps) > 0 or max(steps) < 0)


def named_bands(header: Sequence[str]) -> tuple[tuple[Band, ...], tuple[str, ...]]:
    """The columns that are called by wavelengths, and the kinds of such columns that there are.

    R_400, 400[nm], SPECTRAL_NM_400 and the like: what stands about the number is the same in all of
    them. Of several kinds (SCI and SCE) the most frequent.
    """
    groups: dict[str, list[Band]] = {}
    for band in _bands(header):
        groups.setdefault(band.kind, []).append(band)
    good = {kind: bands for kind, bands in groups.items() if _plausible(kind, bands)}
    if not good:
        return (), ()
    chosen = max(good, key=lambda kind: len(good[kind]))
    rivals = [kind for kind in good if 2 * len(good[kind]) > len(good[chosen])]
    return tuple(good[chosen]), tuple(rivals)


def _bands(header: Sequence[str]) -> Iterator[Band]:
    for column, name in enumerate(header):
        parsed = _NAME.fullmatch(name)
        if parsed is None:
            if is_number(name) and _value(name) > 0:  # 4.0e2
                yield Band(column, "", _value(name), "", False)
            continue
        before, number, behind = parsed.groups()
        words = [w.lower() for w in (*_WORD.findall(before), *_WORD.findall(behind))]
        units = [word for word in words if word in UNITS and word != "a"]
        kind = " ".join(word for word in words if word not in units)
        signed = not words and any(sign in before for sign in "-+")
        value = float(number.replace(",", "."))
        if value > 0 and not signed:
            percent = "%" in before + behind
            yield Band(column, kind, value, units[0] if units else "", percent)


def _plausible(kind: str, bands: Sequence[Band]) -> bool:
    """Whether numbers are wavelengths: samples are numbered too, and values are numbers."""
    values = [band.value for band in bands]
    if len(bands) < _FEWEST or any(band.unit for band in bands) or min(values) >= _SHORTEST:
        return len(bands) >= _FEWEST
    steps = [b - a for a, b in itertools.pairwise(values)]
    in_order = min(steps) > 0 or max(steps) < 0
    return (
        not kind and in_order and _MICROMETRES[0] <= min(values) and max(values) < _MICROMETRES[1]
    )


def _value(text: str) -> float:
    parsed = re.match(r"[+-]?[\d.,]+(?:e[+-]?\d+)?", text, re.IGNORECASE)
    try:
        return float(parsed[0].replace(",", ".")) if parsed else 0.0
    except ValueError:
        return 0.0
