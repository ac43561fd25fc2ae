"""`cutis spectrum`: parameters in, reflectance spectrum out."""

import csv
import difflib
import io
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray


def spectrum(
    skins: options.Skins = None,
    melanin: options.Melanin = None,
    blood: options.Blood = None,
    thickness: options.Thickness = None,
    eumelanin: options.Eumelanin = None,
    oxygenation: options.Oxygenation = None,
    bilirubin: options.Bilirubin = None,
    carotene: options.Carotene = None,
    methaemoglobin: options.Methaemoglobin = None,
    tissue: options.TissueName = "measured2026",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="CSV to write; a plot goes beside it.")
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Reflectance of skin, 380-780 nm, from its parameters.

    One skin gives the columns wavelength_nm,reflectance; a CSV of skins gives a row per skin, its
    columns followed by one per wavelength. Without -o the CSV is printed.

    Bilirubin, carotene and methaemoglobin are 0 unless given, as a flag or a column.

    Example: cutis spectrum --melanin 0.02 --blood 0.01 --thickness 80 -o skin.csv
    """
    from cutis.albedo import albedo_space
    from cutis.errors import CutisError
    from cutis.optics import (
        NAMES,
        RARE_NAMES,
        WAVELENGTHS,
        skin,
        tissue_named,
        with_rare_chromophores,
    )

    if output is not None and output.suffix.lower() != ".csv":
        raise CutisError(f"{output}: the spectrum is a table; end its name in .csv")
    flags = {
        "melanin": melanin,
        "blood": blood,
        "thickness": thickness,
        "eumelanin": eumelanin,
        "oxygenation": oxygenation,
        "bilirubin": bilirubin,
        "carotene": carotene,
        "methaemoglobin": methaemoglobin,
    }
    given = {name: value for name, value in flags.items() if value is not None}
    if skins is not None and given:
        raise CutisError("give either a CSV of skins or parameter flags, not both")
    known = tissue_named(tissue)
    rare = with_rare_chromophores(known)
    if skins is None:
        header = ["wavelength_nm", "reflectance"]
        known = rare if {*given} & {*RARE_NAMES} else known
        spectra = albedo_space(known).reflectance(skin(given, known.parameters))[None]
        rows = [[f"{lam:g}", f"{r:.6f}"] for lam, r in zip(WAVELENGTHS, spectra[0], strict=True)]
    else:
        columns, table, parameters = read_skins(skins, RARE_NAMES)
        header = [*columns, *(f"{lam:g}" for lam in WAVELENGTHS)]
        known = rare if parameters.shape[1] > len(NAMES) else known
        spectra = albedo_space(known).reflectance(parameters)
        rows = [
            [*cells, *(f"{r:.6f}" for r in values)]
            for cells, values in zip(table, spectra, strict=True)
        ]
    if output is not None and skins is not None and output.resolve() == skins.resolve():
        raise CutisError(f"{output.name} is the CSV of skins itself; write to another name")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([header, *rows])
    if output is None:
        typer.echo(text.getvalue(), nl=False)
        return
    from cutis.textures import replacing

    with replacing(output) as partial:
        partial.write_text(text.getvalue(), encoding="utf-8")
    plot = output.with_suffix(".plot.png")  # never the name of a texture beside it
    _plot(plot, WAVELENGTHS, spectra)
    if not quiet:
        typer.echo(f"wrote {output} and {plot}")


def read_skins(
    path: Path, rare: "Sequence[str]" = ()
) -> tuple[list[str], list[list[str]], "NDArray[np.float64]"]:
    """Header, cells and (n, 5) parameters of a CSV; CutisError names the row that is wrong.

    With a column of one of the `rare` chromophores that are welcome, parameters are (n, 8).
    """
    import numpy as np

    from cutis.errors import CutisError
    from cutis.optics import NAMES, PARAMETERS, RARE, RARE_NAMES, skin

    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = (line for line in file if line.strip() and not line.startswith("#"))
            columns, *table = list(csv.reader(lines)) or [[]]
    except FileNotFoundError:
        raise CutisError(f"{path}: no such file") from None
    except (UnicodeDecodeError, csv.Error):
        raise CutisError(f"{path.name}: not a CSV file in UTF-8") from None
    columns = [name.strip() for name in columns]
    for name in columns:
        if name in RARE_NAMES and name not in rare:
            raise CutisError(f"{path.name}: {name} is not taken here; leave its column out")
    names = (*NAMES, *rare)
    known = [i for i, name in enumerate(columns) if name in names]
    for name in set(columns) - set(names):
        if close := difflib.get_close_matches(name.lower(), names, 1, 0.8):
            raise CutisError(f"{path.name}: column {name!r} is not a parameter; is it {close[0]}?")
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
            raise CutisError(f"{path.name}, skin {number}: {error}") from None
    return columns, table, parameters


def _plot(path: Path, wavelengths: "NDArray[np.float64]", spectra: "NDArray[np.float32]") -> None:
    from matplotlib.figure import Figure

    from cutis.colour import encode_srgb, reflectance_to_rgb
    from cutis.textures import replacing

    figure = Figure(figsize=(7, 4.2), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    for values in spectra[:200]:
        colour = encode_srgb(reflectance_to_rgb(values, wavelengths)).clip(0, 1)
        axes.plot(wavelengths, values, color=colour, linewidth=2)
    axes.set(xlabel="wavelength [nm]", ylabel="reflectance", xlim=(380, 780), ylim=(0, None))
    axes.set_facecolor("0.93")
    with replacing(path) as partial:
        figure.savefig(partial)
