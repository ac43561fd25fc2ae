"""Spectra of skins into a table with a plot beside it, and tables of skins."""

import csv
import difflib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import albedo_space
from cutis.colour import encode_srgb, reflectance_to_rgb
from cutis.errors import CutisError
from cutis.jobs.files import check_outputs
from cutis.jobs.job import digest_of
from cutis.maps.defaults import default_tissue
from cutis.maps.estimating import Progress, nobody
from cutis.optics import (
    NAMES,
    PARAMETERS,
    RARE,
    RARE_NAMES,
    WAVELENGTHS,
    Tissue,
    skin,
    with_rare_chromophores,
)
from cutis.spectra import text_cell
from cutis.spectra.sheets import read_text
from cutis.spectra.sheets import rows as rows_of
from cutis.textures import replacing, sweep
from cutis.textures.problem import shorten


@dataclass(frozen=True)
class Spectrum:
    """The table as text where it has no file, else the files that were written."""

    table: str | None = None
    files: tuple[Path, ...] = ()


@dataclass(frozen=True)
class SpectrumJob:
    """Skins of a CSV file, or the one of `given` parameters; a .csv to write, None for its text."""

    skins: Path | None = None
    given: Mapping[str, float] = field(default_factory=dict)
    tissue: Tissue = field(default_factory=default_tissue)
    output: Path | None = field(default=None, metadata={"result": False})

    def __post_init__(self) -> None:
        if self.output is not None and self.output.suffix.lower() != ".csv":
            raise CutisError(f"{self.output}: the spectrum is a table; end its name in .csv")
        if self.skins is not None and self.given:
            raise CutisError("give either a CSV of skins or parameter flags, not both")

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> Spectrum:
        """Works the spectra out."""
        check_outputs([self.output], {"the CSV of skins": self.skins})
        tissue, rare = self.tissue, with_rare_chromophores(self.tissue)
        if self.skins is None:
            header = ["wavelength_nm", "reflectance"]
            tissue = rare if {*self.given} & {*RARE_NAMES} else tissue
            one = skin(self.given, tissue.parameters)
            spectra = albedo_space(tissue).reflectance(one)[None]
            lines = zip(WAVELENGTHS, spectra[0], strict=True)
            rows = [[f"{lam:g}", f"{r:.6f}"] for lam, r in lines]
        else:
            columns, table, parameters = read_skins(self.skins, RARE_NAMES)
            header = [*map(text_cell, columns), *(f"{lam:g}" for lam in WAVELENGTHS)]
            tissue = rare if parameters.shape[1] > len(NAMES) else tissue
            spectra = albedo_space(tissue).reflectance(parameters)
            rows = [
                [*map(text_cell, cells), *(f"{r:.6f}" for r in values)]
                for cells, values in zip(table, spectra, strict=True)
            ]
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows([header, *rows])
        if self.output is None:
            return Spectrum(text.getvalue())
        sweep(self.output.parent)
        with replacing(self.output) as partial:
            partial.write_text(text.getvalue(), encoding="utf-8")
        plot = self.output.with_suffix(".plot.png")  # never the name of a texture beside it
        _plot(plot, WAVELENGTHS, spectra)
        return Spectrum(None, (self.output, plot))


def read_skins(
    path: Path, rare: Sequence[str] = ()
) -> tuple[list[str], list[list[str]], NDArray[np.float64]]:
    """Header, cells and (n, 5) parameters of a CSV; CutisError names the row that is wrong.

    With a column of one of the `rare` chromophores that are welcome, parameters are (n, 8).
    """
    lines = rows_of(path, read_text(path), ",")
    while lines and lines[0].cells[0].startswith("#"):  # comments stand before the header
        lines.pop(0)
    columns = lines[0].cells if lines else []
    table = [row.cells for row in lines[1:]]
    for name in columns:
        if name in RARE_NAMES and name not in rare:
            raise CutisError(f"{path.name}: {name} is not taken here; leave its column out")
    names = (*NAMES, *rare)
    known = [i for i, name in enumerate(columns) if name in names]
    for name in set(columns) - set(names):
        if close := difflib.get_close_matches(name.lower(), names, 1, 0.8):
            said = f"column '{shorten(name)}' is not a parameter; is it {close[0]}?"
            raise CutisError(f"{path.name}: {said}")
    if not known or not table:
        raise CutisError(
            f"{path.name}: needs a header with some of {', '.join(NAMES)} and a row per skin"
        )
    order = (*PARAMETERS, *RARE) if {*columns} & {*rare} else PARAMETERS
    parameters = np.empty((len(table), len(order)))
    for number, cells in enumerate(table, 1):
        try:
            if len(cells) != len(columns):
                raise CutisError(f"{len(cells)} cells under {len(columns)} columns")
            parameters[number - 1] = skin({columns[i]: float(cells[i]) for i in known}, order)
        except ValueError as error:
            raise CutisError(f"{path.name}, skin {number}: {shorten(str(error))}") from None
    return columns, table, parameters


def _plot(path: Path, wavelengths: NDArray[np.float64], spectra: NDArray[np.float32]) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.2), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    for values in spectra[:200]:
        colour = encode_srgb(reflectance_to_rgb(values, wavelengths)).clip(0, 1)
        axes.plot(wavelengths, values, color=colour, linewidth=2)
    axes.set(xlabel="wavelength [nm]", ylabel="reflectance", xlim=(380, 780), ylim=(0, None))
    axes.set_facecolor("0.93")
    with replacing(path) as partial:
        figure.savefig(partial)
