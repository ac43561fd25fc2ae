"""ENVI files: a text header, NAME.hdr, beside the raw values [envi].

Cubes in bsq, bil or bip order, and spectral libraries, which are tables.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.spectra.reflectance import nanometres
from cutis.spectra.spectral_cube import SpectralCube
from cutis.spectra.stored import StoredArray
from cutis.textures.problem import problem, shorten
from cutis.textures.regular import read_regular

DATA = ("", ".img", ".raw", ".dat", ".bsq", ".bil", ".bip", ".bin", ".cube", ".sli", ".lib")
"""Endings under which the values lie beside NAME.hdr."""
_TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8"}
_LONGEST = 1 << 22  # bytes of a header
# Where lines, samples and bands stand in each order.
_AXES = {"bsq": (1, 2, 0), "bil": (0, 2, 1), "bip": (0, 1, 2)}
_NO_WAVELENGTHS = "does not say its wavelengths; list them by --wavelengths FILE"


class EnviHeader:
    """What a header says; `data` is the file of values beside it."""

    def __init__(self, path: Path) -> None:
        self.path, self.data = pair(path)
        self.fields = read_header(self.path)

    @property
    def library(self) -> bool:
        """Whether it is of a spectral library."""
        return "spectral library" in self.fields.get("file type", "").lower()

    def whole(self, name: str, default: int | None = None) -> int:
        """A whole number."""
        text = self.fields.get(name)
        if text is None and default is not None:
            return default
        try:
            value = int(float(text)) if text and "." in text else int(text or "")
        except (ValueError, OverflowError):
            raise problem(self.path, f"does not say its {name}; repair the header") from None
        return value

    def number(self, name: str) -> float | None:
        """A number, or None where there is none."""
        if name not in self.fields:
            return None
        try:
            return float(self.fields[name])
        except ValueError:
            raise problem(self.path, f"its {name} is not a number; repair the header") from None

    def listed(self, name: str) -> list[str]:
        """The cells of a list; what is empty at its end is none."""
        cells = [cell.strip() for cell in self.fields.get(name, "").strip("{} \n").split(",")]
        while cells and not cells[-1]:
            cells.pop()
        return cells

    def wavelengths(self) -> tuple[NDArray[np.float64], list[str]]:
        """Those of its bands, nm, with notes."""
        name = next((n for n in ("wavelength", "wavelengths") if n in self.fields), None)
        if name is None:
            raise problem(self.path, _NO_WAVELENGTHS)
        try:
            values = [float(cell) for cell in self.listed(name)]
        except ValueError:
            what = "its wavelengths are not numbers; repair the header"
            raise problem(self.path, what) from None
        unit = self.fields.get("wavelength units", self.fields.get("wavelength unit"))
        return nanometres(self.path, values, unit)

    def open(self) -> tuple[StoredArray, tuple[int, int, int], str]:
        """The values beside it, and their lines, samples, bands and interleave."""
        lines, samples = self.whole("lines"), self.whole("samples")
        bands, offset = self.whole("bands"), self.whole("header offset", 0)
        kind, order = self.whole("data type"), self.whole("byte order", 0)
        interleave = self.fields.get("interleave", "").lower()
        if interleave not in _AXES:
            what = f"interleave is '{shorten(interleave)}', not bsq, bil or bip"
            raise problem(self.path, what)
        if kind not in _TYPES or order not in (0, 1):
            what = f"data type {kind}, byte order {order} are not known; convert it"
            raise problem(self.path, what)
        if self.fields.get("file compression", "0").strip() not in ("0", ""):
            raise problem(self.path, "its values are compressed; store them plain")
        dtype = np.dtype(_TYPES[kind]).newbyteorder("<" if order == 0 else ">")
        size = (lines, samples, bands)
        stored = [int(axis) for axis in np.argsort(_AXES[interleave])]
        shape = tuple(size[axis] for axis in stored)
        return StoredArray(self.data, dtype, offset, shape, stored.index(0)), size, interleave


class EnviCube(SpectralCube):
    """An ENVI cube, named by its header or by its data file."""

    def __init__(
        self, path: Path, given: tuple[NDArray[np.float64], list[str]] | None = None
    ) -> None:
        self.path = path
        header = EnviHeader(path)
        if header.library:
            raise problem(header.path, "is a spectral library, a table; its skins are a table too")
        self.shape = (header.whole("lines"), header.whole("samples"))
        self._check()
        self._array, (_, _, bands), interleave = header.open()
        try:
            self._axes = _AXES[interleave]
            found = header.wavelengths() if given is None else given
            self.wavelengths, self.notes = found[0], list(found[1])
            if len(self.wavelengths) != bands:
                what = f"{len(self.wavelengths)} wavelengths are given for {bands} bands"
                raise problem(
                    header.path, f"{what}; repair the header or list them by --wavelengths"
                )
            self._ignore = header.number("data ignore value")
            self.scale = header.number("reflectance scale factor")
            if self.scale is not None and not 0 < self.scale < np.inf:
                self.scale = None
            self._bad = self._bad_bands(header, bands)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Lets go of the file."""
        self._array.close()

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """(h, W, n) values of some rows."""
        stored = self._array.rows(rows).transpose(self._axes)
        with np.errstate(over="ignore", invalid="ignore"):
            found = np.array(stored, dtype=np.float32, order="C")
        if self._ignore is not None:
            found[stored == self._ignore] = np.nan
        found[..., self._bad] = np.nan
        return found

    def _bad_bands(self, header: EnviHeader, bands: int) -> NDArray[np.bool_]:
        """(bands,) which the header's list of bad bands (0: bad) leaves out."""
        if "bbl" not in header.fields:
            return np.zeros(bands, dtype=bool)
        try:
            good = np.array([float(cell) for cell in header.listed("bbl")])
        except ValueError:
            good = np.empty(0)
        if len(good) != bands:
            what = f"its list of bad bands does not fit {bands} bands; repair it"
            raise problem(header.path, what)
        if (good == 0).any():
            self.notes.append(f"{int((good == 0).sum())} bands are marked as bad: left out")
        return np.asarray(good == 0)


def read_header(path: Path) -> dict[str, str]:
    """The fields of an ENVI header, names in lower case, lists with their braces."""
    text = read_regular(path, _LONGEST).decode("utf-8-sig", "replace")
    first, _, rest = text.partition("\n")
    if first.strip() != "ENVI":
        raise problem(path, "is no ENVI header (its first line is not ENVI)")
    fields: dict[str, str] = {}
    lines = iter(rest.splitlines())
    for line in lines:
        name, equals, value = line.partition("=")
        if not equals or line.lstrip().startswith(";"):
            continue
        if "{" in value:
            parts = [value]
            while "}" not in parts[-1]:
                following = next(lines, None)
                if following is None:
                    raise problem(path, f"the list of {shorten(name.strip())} has no end")
                parts.append(following)
            value = " ".join(parts)
        fields[" ".join(name.lower().replace("_", " ").split())] = value.strip()
    return fields


def pair(path: Path) -> tuple[Path, Path]:
    """Header and data file that are named by either.

    Raises CutisError where the other is not there.
    """
    if path.suffix.lower() == ".hdr":
        candidates = [path.with_suffix(ending) for ending in (*DATA, *map(str.upper, DATA))]
        data = next((one for one in candidates if one.is_file()), None)
        if data is None:
            listed = ", ".join(filter(None, DATA))
            raise problem(path, f"no file of values beside it ({listed} or no ending)")
        return path, data
    for header in (path.with_suffix(".hdr"), path.with_name(f"{path.name}.hdr")):
        if header.is_file():
            return header, path
    raise problem(
        path, "is no CSV, EXR or NPY, and has no ENVI header (NAME.hdr) beside it; give spectra"
    )
