"""Measured skins of the larger data, for comparison."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

BANDS = np.arange(400.0, 701.0, 10.0)
"""nm, what both archives cover."""
SURFACE = 0.028
"""Reflected at once by a smooth surface of n = 1.4, at normal incidence."""


def measured_skins(data: Path) -> NDArray[np.float64]:
    """(n, 31) albedo at BANDS of the skins in `data`/spectra/measured, without the surface's part.

    Both archives hold measured = ρ + (1 − ρ) · albedo, the specular part included [issa2025,
    cooksey2017nist]; records marked as implausible are left out.
    """
    folder = data / "spectra" / "measured"
    spectra = []
    with (folder / "issa_half_a.csv").open() as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        for row in rows:
            if row["qc"] == "0":
                spectra.append([float(row[f"{band:g}"] or "nan") for band in BANDS])
    with (folder / "nist_forearm_half_a.csv").open() as file:
        lines = [line for line in file if not line.startswith("#")]
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    spectra += [np.interp(BANDS, table[:, 0], column) for column in table[:, 1:].T]
    found = np.array(spectra)
    found = found[np.isfinite(found).all(axis=1)]
    return np.asarray((found - SURFACE) / (1 - SURFACE))
