"""`cutis fit`: measured reflectance in, the skin that explains it out."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def fit(
    spectra: Annotated[
        Path,
        typer.Argument(help="CSV of spectra, or a cube: ENVI .hdr, spectral .exr, .npy."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="CSV, or for a cube maps, NAME.skin.exr."),
    ] = None,
    specular: Annotated[
        float,
        typer.Option(
            "--specular",
            help="Surface reflection that the spectra include: 0.028 for instruments that leave "
            "the specular part in (SCI, 8°/diffuse), 0 where it is left out.",
        ),
    ] = 0.0,
    tissue: options.TissueName = "measured2026",
    shift: Annotated[
        float,
        typer.Option(
            "--shift", help="nm by which the instrument's wavelengths are too short, if known."
        ),
    ] = 0.0,
    wavelength_range: Annotated[
        str, typer.Option("--range", help="Wavelengths to fit, in nm: 400,700.")
    ] = "380,780",
    wavelengths: Annotated[
        Path | None,
        typer.Option("--wavelengths", help="List of a cube's wavelengths, nm: text or .npy."),
    ] = None,
    scale: Annotated[
        float | None, typer.Option("--scale", help="Stored value that means a reflectance of 1.")
    ] = None,
    noise: Annotated[
        float | None,
        typer.Option("--noise", help="Standard deviation of a reflectance; else the residual's."),
    ] = None,
    melanin: options.Melanin = None,
    blood: options.Blood = None,
    thickness: options.Thickness = None,
    eumelanin: options.Eumelanin = None,
    oxygenation: options.Oxygenation = None,
    bilirubin: options.Bilirubin = None,
    carotene: options.Carotene = None,
    methaemoglobin: options.Methaemoglobin = None,
    free: Annotated[
        list[str] | None,
        typer.Option(
            "--free",
            help="Find this too: bilirubin, carotene or methaemoglobin, 0 else; may be repeated.",
        ),
    ] = None,
    correlations: Annotated[
        bool, typer.Option("--correlations", help="Columns of correlations between parameters.")
    ] = False,
    quiet: options.Quiet = False,
) -> None:
    """Parameters of skin from measured reflectance spectra, each with its standard deviation.

    A CSV holds wavelength_nm and a column per spectrum, or a row per spectrum under columns called
    by wavelengths. A parameter flag holds that parameter at a value. Without -o the CSV is printed.

    Example: cutis fit spectra.csv --specular 0.028 --range 400,700 -o skins.csv
    """
    from cutis.jobs.fit import Request, fit_cube, fit_table
    from cutis.spectra import is_table

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
    held = {name: value for name, value in flags.items() if value is not None}
    low, high = _range(wavelength_range)
    request = Request(
        spectra, output, specular, low, high, scale, noise, held, quiet, tissue, shift,
        tuple(free or ()),
    )  # fmt: skip
    if is_table(spectra):
        fit_table(request, correlations)
    else:
        fit_cube(request, wavelengths)


def _range(text: str) -> tuple[float, float]:
    from cutis.errors import CutisError

    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        low, high = 1.0, 0.0
    if not 0 < low < high:
        raise CutisError(f"--range takes two wavelengths in nm like 400,700, not {text!r}")
    return low, high
