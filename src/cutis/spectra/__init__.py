"""Measured spectra in and out: tables of instruments, cubes of spectral cameras."""

from cutis.spectra.cube_files import open_cube
from cutis.spectra.spectral_cube import SpectralCube
from cutis.spectra.table_files import SpectraFile, read_spectra

__all__ = ["SpectraFile", "SpectralCube", "open_cube", "read_spectra"]
