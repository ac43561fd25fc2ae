"""Measured spectra in and out: tables of instruments, cubes of spectral cameras."""

from cutis.spectra.cells import text_cell
from cutis.spectra.cube_files import open_cube
from cutis.spectra.libraries import is_table, open_table
from cutis.spectra.spectral_cube import SpectralCube
from cutis.spectra.table_files import SpectraFile, read_spectra

__all__ = [
    "SpectraFile",
    "SpectralCube",
    "is_table",
    "open_cube",
    "open_table",
    "read_spectra",
    "text_cell",
]
