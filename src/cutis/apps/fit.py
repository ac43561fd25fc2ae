"""`cutis fit`: measured reflectance in, the skin that explains it out."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


@options.parameter_values
def fit(
    spectra: Annotated[
        Path,
        typer.Argument(help="CSV of spectra, or a cube: ENVI .hdr, spectral .exr, .npy."),
    ],
    values: options.Values,
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
    force: Annotated[
        bool, typer.Option("--force", help="Keep the result also where it looks like no skin.")
    ] = False,
    quiet: options.Quiet = False,
) -> None:
    """Parameters of skin from measured reflectance spectra, each with its standard deviation.

    A CSV holds wavelength_nm and a column per spectrum, or a row per spectrum under columns called
    by wavelengths. A parameter flag holds that parameter at a value. Without -o the CSV is printed.

    Example: cutis fit spectra.csv --specular 0.028 --range 400,700 -o skins.csv
    """
    from cutis.apps.console import bar, err
    from cutis.jobs.fit import FitJob

    low, high = options.wavelength_range(wavelength_range)
    job = FitJob(
        spectra, output, options.tissue_of(tissue), specular, shift, low, high, wavelengths, scale,
        noise, values, tuple(free or ()), correlations, force,
    )  # fmt: skip
    with bar(quiet) as progress:
        found = job.run(progress)
    if found.table is not None:
        typer.echo(found.table, nl=False)
    for note in () if quiet else (*found.notes, found.summary):
        err.say(f"{spectra.name}: {note}")  # results may go to stdout
