"""Hyperspectral cubes by their files: spectral EXR, NPY, and ENVI (`envi.py`).

A spectral EXR has the layout of Fichet et al. [fichet2021]: a channel T.<wavelength> of reflectance
for every band, or S0.<wavelength> of radiance, where the wavelength is written as 550,000000nm.
"""

import os
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.spectra.envi import EnviCube
from cutis.spectra.spectral_cube import SpectralCube
from cutis.spectra.stored import StoredArray, npy_header
from cutis.spectra.wavelengths import read_wavelengths
from cutis.textures.channels import ChannelFile
from cutis.textures.problem import problem, shorten
from cutis.textures.regular import open_regular

LIGHT_SPEED = 299_792_458e9
"""nm/s."""
_CHANNEL = re.compile(
    r"(S0|T)\.(\d*[.,]?\d+|\d+[.,]?)(e[+-]?\d+)?(da|[YZEPTGMkhdcmunp])?(m|Hz)", re.IGNORECASE
)
_PREFIX = {
    "Y": 1e24, "Z": 1e21, "E": 1e18, "P": 1e15, "T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2,
    "da": 1e1, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "": 1.0,
}  # fmt: skip


def open_cube(
    path: str | os.PathLike[str], wavelengths: str | os.PathLike[str] | None = None
) -> SpectralCube:
    """The cube in `path`: an .exr, a .npy, or an ENVI header or its data file.

    `wavelengths` names a list of them, as .npy or text. An .npy without it has them beside it, in
    NAME.wavelengths.csv, .txt or .npy. Raises CutisError, one line that names the file, for files
    that are missing, damaged, or do not say their wavelengths.
    """
    path = Path(path)
    open_regular(path).close()
    given = None if wavelengths is None else read_wavelengths(wavelengths)
    suffix = path.suffix.lower()
    if suffix == ".exr":
        if given is not None:
            raise problem(path, "says its wavelengths itself; leave out --wavelengths")
        return ExrCube(path)
    if suffix == ".npy":
        return NpyCube(path, given)
    return EnviCube(path, given)


class ExrCube(SpectralCube):
    """A spectral EXR."""

    def __init__(self, path: Path) -> None:
        self.path, self.notes = path, []
        self._file = ChannelFile(path)
        self.shape = self._file.shape
        found: dict[str, dict[float, str]] = {"T": {}, "S0": {}}
        for name in self._file.names:
            if (parsed := channel_wavelength(name)) is not None:
                found[parsed[0]][parsed[1]] = name
        chosen = found["T"] or found["S0"]
        if not chosen:
            self.close()
            listed = shorten(", ".join(self._file.names[:6]))
            what = f"has no spectral channels T.550,000000nm or S0.… (but {listed})"
            raise problem(path, f"{what}; a colour texture is for cutis estimate")
        if not found["T"]:
            self.notes.append("no channels T.…: radiance S0 is taken for reflectance")
        self.wavelengths = np.array(sorted(chosen))
        self._names = [chosen[lam] for lam in sorted(chosen)]

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """(h, W, n) values of some rows."""
        channels = self._file.rows(rows)
        return np.stack([channels[name] for name in self._names], axis=-1)


def channel_wavelength(name: str) -> tuple[str, float] | None:
    """("T" or "S0", nm) of a channel of a spectral EXR; None of any other channel."""
    parsed = _CHANNEL.fullmatch(name)
    if parsed is None:
        return None
    kind, digits, power, prefix, unit = parsed.groups()
    prefix = prefix or ""
    if prefix not in _PREFIX:
        return None
    value = float(digits.replace(",", ".") + (power or "")) * _PREFIX[prefix]
    if value <= 0:
        return None
    nm = value * 1e9 if unit == "m" else LIGHT_SPEED / value
    return kind.upper(), round(nm, 6)


class NpyCube(SpectralCube):
    """A NumPy array (H, W, n), or (n, H, W) where only the first axis fits the wavelengths."""

    def __init__(
        self, path: Path, given: tuple[NDArray[np.float64], list[str]] | None = None
    ) -> None:
        self.path = path
        dtype, shape, fortran, offset = npy_header(path)
        if given is None:
            given = self._beside()
        self.wavelengths, self.notes = given[0], list(given[1])
        count = len(self.wavelengths)
        if len(shape) == 2 and shape[1] == count:
            shape = (shape[0], 1, count)
        self._bands_first = len(shape) == 3 and shape[2] != count and shape[0] == count
        if self._bands_first:
            self.notes.append("bands are along the first axis")
        if len(shape) != 3 or count not in (shape[2], shape[0]):
            what = f"has the shape {shape}, which does not fit {count} wavelengths"
            raise problem(path, f"{what}; save it as (height, width, wavelengths)")
        self.shape = (shape[1], shape[2]) if self._bands_first else (shape[0], shape[1])
        self._check()
        lines = int(self._bands_first)
        self._reversed = fortran  # Fortran's order is that of C with the axes reversed
        stored = shape[::-1] if fortran else shape
        self._array = StoredArray(path, dtype, offset, stored, 2 - lines if fortran else lines)

    def _beside(self) -> tuple[NDArray[np.float64], list[str]]:
        for suffix in (".csv", ".txt", ".npy"):
            beside = self.path.with_suffix(f".wavelengths{suffix}")
            if beside.is_file():
                return read_wavelengths(beside)
        raise problem(self.path, "does not say its wavelengths; list them by --wavelengths FILE")

    def close(self) -> None:
        """Lets go of the file."""
        self._array.close()

    def rows(self, rows: slice) -> NDArray[np.float32]:
        """(h, W, n) values of some rows."""
        stored = self._array.rows(rows)
        values = stored.transpose() if self._reversed else stored
        values = np.moveaxis(values, 0, 2) if self._bands_first else values
        with np.errstate(over="ignore"):
            return np.ascontiguousarray(values, dtype=np.float32)
