"""ENVI cubes: a text header, NAME.hdr, beside the raw values, in bsq, bil or bip order."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.spectra.reflectance import nanometres
from cutis.spectra.spectral_cube import SpectralCube
from cutis.textures.problem import problem, shorten

DATA = ("", ".img", ".raw", ".dat", ".bsq", ".bil", ".bip", ".bin", ".cube")
"""Endings under which the values lie beside NAME.hdr."""
_TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8"}
_LONGEST = 1 << 22  # bytes of a header
# Where lines, samples and bands stand in each order.
_AXES = {"bsq": (1, 2, 0), "bil": (0, 2, 1), "bip": (0, 1, 2)}


class EnviCube(SpectralCube):
    """An ENVI cube, named by its header or by its data file."""

    def __init__(
        self, path: Path, given: tuple[NDArray[np.float64], list[str]] | None = None
    ) -> None:
        self.path = path
        header, data = _pair(path)
        fields = read_header(header)
        lines, samples, bands, offset, kind, order = (
            _whole(header, fields, name, default)
            for name, default in (
                ("lines", None), ("samples", None), ("bands", None), ("header offset", 0),
                ("data type", None), ("byte order", 0),
            )
        )  # fmt: skip
        interleave = fields.get("interleave", "").lower()
        if interleave not in _AXES:
            raise problem(header, f"interleave is {shorten(interleave)!r}, not bsq, bil or bip")
        if kind not in _TYPES or order not in (0, 1):
            raise problem(header, f"data type {kind}, byte order {order} are not known; convert it")
        if fields.get("file compression", "0").strip() not in ("0", ""):
            raise problem(header, "its values are compressed; store them plain")
        self.shape = (lines, samples)
        self._check()
        dtype = np.dtype(_TYPES[kind]).newbyteorder("<" if order == 0 else ">")
        need = offset + lines * samples * bands * dtype.itemsize
        if bands < 1 or offset < 0 or data.stat().st_size < need:
            what = f"is {data.stat().st_size} bytes long where its header claims {need}"
            raise problem(data, f"{what}; copy or export it again")
        stored = [(lines, samples, bands)[axis] for axis in _stored(interleave)]
        array = np.memmap(data, dtype, "r", offset, tuple(stored))
        self._array: NDArray[np.generic] = array.transpose(_AXES[interleave])
        self.wavelengths, self.notes = _wavelengths(header, fields, given)
        if len(self.wavelengths) != bands:
            what = f"{len(self.wavelengths)} wavelengths are given for {bands} bands"
            raise problem(header, f"{what}; repair the header or list them by --wavelengths")
        self._ignore = _number(header, fields, "data ignore value")
        self.scale = _number(header, fields, "reflectance scale factor")
        if self.scale is not None and not self.scale > 0:
            self.scale = None
        self._bad = self._bad_bands(header, fields, bands)

    def close(self) -> None:
        """Lets go of the file."""
        self._array = np.empty((0, 0, 0))

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """(h, W, n) values of some rows."""
        stored = self._array[rows]
        found = np.array(stored, dtype=np.float32, order="C")
        if self._ignore is not None:
            found[stored == self._ignore] = np.nan
        found[..., self._bad] = np.nan
        return found

    def _bad_bands(self, header: Path, fields: dict[str, str], bands: int) -> NDArray[np.bool_]:
        """(bands,) which the header's list of bad bands (0: bad) leaves out."""
        if "bbl" not in fields:
            return np.zeros(bands, dtype=bool)
        try:
            good = np.array([float(c) for c in fields["bbl"].strip("{} \n").split(",")])
        except ValueError:
            good = np.empty(0)
        if len(good) != bands:
            raise problem(header, f"its list of bad bands does not fit {bands} bands; repair it")
        if (good == 0).any():
            self.notes.append(f"{int((good == 0).sum())} bands are marked as bad: left out")
        return np.asarray(good == 0)


def read_header(path: Path) -> dict[str, str]:
    """The fields of an ENVI header, names in lower case, lists with their braces."""
    if path.stat().st_size > _LONGEST:
        raise problem(path, "is too long for an ENVI header")
    text = path.read_text(encoding="utf-8", errors="replace")
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
        fields[" ".join(name.lower().split())] = value.strip()
    return fields


def _pair(path: Path) -> tuple[Path, Path]:
    """Header and data file of a cube that is named by either."""
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


def _stored(interleave: str) -> tuple[int, ...]:
    """Which of lines, samples and bands each stored axis is."""
    return tuple(int(axis) for axis in np.argsort(_AXES[interleave]))


def _whole(path: Path, fields: dict[str, str], name: str, default: int | None) -> int:
    text = fields.get(name)
    if text is None and default is not None:
        return default
    try:
        return int(text or "")
    except ValueError:
        raise problem(path, f"does not say its {name}; repair the header") from None


def _number(path: Path, fields: dict[str, str], name: str) -> float | None:
    if name not in fields:
        return None
    try:
        return float(fields[name])
    except ValueError:
        raise problem(path, f"its {name} is not a number; repair the header") from None


def _wavelengths(
    path: Path, fields: dict[str, str], given: tuple[NDArray[np.float64], list[str]] | None
) -> tuple[NDArray[np.float64], list[str]]:
    """Wavelengths of an ENVI header, or those given."""
    if given is not None:
        return given[0], list(given[1])
    try:
        values = [float(cell) for cell in fields["wavelength"].strip("{} \n").split(",")]
    except KeyError:
        raise problem(
            path, "does not say its wavelengths; list them by --wavelengths FILE"
        ) from None
    except ValueError:
        raise problem(path, "its wavelengths are not numbers; repair the header") from None
    return nanometres(path, values, fields.get("wavelength units"))
