"""Measured skins of the larger data: spectra, and who they are of."""

import csv
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studies.prior_training import MeasuredSkins

BANDS = np.arange(400.0, 701.0, 10.0)
"""nm, what both archives cover."""
SURFACE = 0.028
"""Reflected at once by a smooth surface of n = 1.4, at normal incidence."""
NIST = 12
"""Origin of the forearms of NIST, beside the eleven of ISSA."""
ORIGINS = {
    1: "UK", 2: "China", 3: "Iraq", 4: "Thailand", 5: "Pakistan", 6: "Spain", 7: "UK 2", 8: "UK 3",
    9: "Japan", 10: "China 2", 11: "Saudi Arabia", NIST: "NIST",
}  # fmt: skip
"""Where skins were measured, by number [issa2025, cooksey2017nist]."""
FACE_SITES = (2, 3, 4, 6, 8, 9)
"""Numbers of places on face and neck: cheeks, chin, forehead, neck and nose."""
GROUPS = {
    "AB": "Arabian", "AF": "African", "CA": "Caucasian", "CN": "Chinese", "IQ": "Iraqi",
    "JP": "Japanese", "SA": "South Asian", "TH": "Thai", "NIST": "NIST",
}  # fmt: skip
"""Groups of the archive; NIST does not say."""


@dataclass(frozen=True, eq=False)
class ArchivedSkins(MeasuredSkins):
    """Measured skins with keys of `ORIGINS` (n,) and of `GROUPS` (n,), and numbers of sites (n,).

    Sites are those of ISSA's places on the body; -1 where none is known.
    """

    origins: NDArray[np.intp]
    groups: NDArray[np.str_]
    sites: NDArray[np.intp]

    def some(self, rows: ArrayLike) -> "ArchivedSkins":
        """Those of some rows."""
        kept = np.asarray(rows)
        return replace(
            self,
            spectra=self.spectra[kept],
            subjects=self.subjects[kept],
            origins=self.origins[kept],
            groups=self.groups[kept],
            sites=self.sites[kept],
        )


def read_skins(data: Path) -> ArchivedSkins:
    """The skins in `data`/spectra/measured at BANDS, as measured: first ISSA, then NIST.

    Both archives hold measured = ρ + (1 − ρ) · albedo, the specular part included [issa2025,
    cooksey2017nist]. Records marked as implausible, and those that lack a band, are left out.
    """
    folder = data / "spectra" / "measured"
    spectra, people = [], []
    for row in csv.DictReader(lines_of(folder / "issa_half_a.csv")):
        if row["qc"] == "0":
            spectra.append([float(row[f"{band:g}"] or "nan") for band in BANDS])
            origin = int(row["origin"])
            site = int(row["location"] or -1)
            people.append((f"{ORIGINS[origin]} {row['subject']}", origin, row["group"], site))
    header, *lines = lines_of(folder / "nist_forearm_half_a.csv")
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    for name, column in zip(header.strip().split(",")[1:], table[:, 1:].T, strict=True):
        spectra.append(np.interp(BANDS, table[:, 0], column))
        people.append((f"NIST {name}", NIST, "NIST", -1))
    subjects, origins, groups, sites = (np.array(column) for column in zip(*people, strict=True))
    skins = ArchivedSkins(np.array(spectra), BANDS, subjects, SURFACE, origins, groups, sites)
    return skins.some(np.isfinite(skins.spectra).all(axis=1))


def measured_skins(data: Path) -> NDArray[np.float64]:
    """(n, 31) albedo at BANDS of the skins of `read_skins`, without the surface's part."""
    return np.asarray((read_skins(data).spectra - SURFACE) / (1 - SURFACE))


def lines_of(path: Path) -> Iterator[str]:
    """Lines of a table without its comments."""
    with path.open(encoding="utf-8") as file:
        yield from (line for line in file if not line.startswith("#"))
