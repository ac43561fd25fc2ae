"""`cutis spectrum`: parameters in, reflectance spectrum out."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


@options.parameter_values
def spectrum(
    values: options.Values,
    skins: options.Skins = None,
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
    from cutis.apps.console import out
    from cutis.jobs.spectrum import SpectrumJob

    found = SpectrumJob(skins, values, options.tissue_of(tissue), output).run()
    if found.table is not None:
        typer.echo(found.table, nl=False)
    elif not quiet:
        out.say(f"wrote {' and '.join(str(path) for path in found.files)}")
