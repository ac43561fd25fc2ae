"""`cutis fit`: measured spectra in, what the skin is made of out."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from cutis.inverse.spectra import SpectraFit


def fit(
    spectra: Annotated[
        Path,
        typer.Argument(help="CSV: wavelength_nm and a column per spectrum, or a row per spectrum."),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="CSV of skins; printed without it.")
    ] = None,
    specular: Annotated[
        float,
        typer.Option(
            help="Share of light that the surface reflects into the measurement: 0.028 where the "
            "specular component is included, 0 where it is not."
        ),
    ] = 0.0,
    low: Annotated[float, typer.Option("--from", help="First wavelength to use, nm.")] = 380.0,
    high: Annotated[float, typer.Option("--to", help="Last wavelength to use, nm.")] = 780.0,
    quiet: options.Quiet = False,
) -> None:
    """Find the skins that explain measured reflectance spectra, with their uncertainty.

    Each row of the result has the spectrum's own columns, the five parameters, a standard deviation
    for each (NAME.sigma), and the root mean square error of the fit.

    Example: cutis fit spectra.csv --specular 0.028 --from 400 --to 700 -o skins.csv
    """
    import csv
    import io

    import numpy as np

    from cutis.apps.console import out, steps
    from cutis.apps.spectra_table import read_spectra
    from cutis.errors import CutisError
    from cutis.optics import NAMES, WAVELENGTHS
    from cutis.textures import replacing

    if output is not None and output.suffix.lower() != ".csv":
        raise CutisError(f"{output}: the result is a table; end its name in .csv")
    if output is not None and output.resolve() == spectra.resolve():
        raise CutisError(f"{output.name} is the CSV of spectra itself; write to another name")
    table = read_spectra(spectra)
    if table.wavelengths.max() < 3:
        raise CutisError(f"{spectra.name}: its wavelengths look like µm; give them in nm")
    known = WAVELENGTHS[[0, -1]]
    inside = (table.wavelengths >= max(low, known[0])) & (table.wavelengths <= min(high, known[1]))
    with steps(1, quiet) as progress:
        found = fit_patterns(
            table.wavelengths[inside], table.spectra[:, inside], specular, progress.at
        )
    header = [*table.labels, *NAMES, *(f"{name}.sigma" for name in NAMES), "rmse"]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for cells, skin, sigma, rmse in zip(
        table.cells, found.parameters, found.sigma, found.rmse, strict=True
    ):
        writer.writerow([*cells, *(f"{v:.6g}" for v in (*skin, *sigma, rmse))])
    if output is None:
        typer.echo(text.getvalue(), nl=False)
        return
    with replacing(output) as partial:
        partial.write_text(text.getvalue(), encoding="utf-8")
    if quiet:
        return
    left = int((~inside).sum())
    if left:
        out.print(f"{left} wavelengths outside {low:g} to {high:g} or 380 to 780 nm are left out")
    bad = int(np.isnan(found.rmse).sum())
    if bad:
        out.print(f"{bad} spectra have fewer values than parameters; their cells are nan")
    if bad < len(found.rmse):
        out.print(
            f"{len(found.rmse) - bad} spectra, rmse {np.nanmean(found.rmse):.4f} in the mean, "
            f"{np.nanmax(found.rmse):.4f} at most; wrote {output}"
        )


def fit_patterns(
    wavelengths: "NDArray[np.float64]",
    spectra: "NDArray[np.float64]",
    specular: float,
    progress: "Callable[[int, int, str], None]",
) -> "SpectraFit":
    """Fits spectra (n, m) with empty cells (NaN), those of one pattern together.

    NaN where fewer values than parameters are left.
    """
    import numpy as np

    from cutis.inverse.spectra import SpectraFit, check_wavelengths, fit_spectra
    from cutis.optics import PARAMETERS

    check_wavelengths(wavelengths)
    count = len(PARAMETERS)
    result = SpectraFit(
        np.full((len(spectra), count), np.nan), np.full((len(spectra), count), np.nan),
        np.full((len(spectra), count, count), np.nan), np.full(len(spectra), np.nan),
        np.full(spectra.shape, np.nan),
    )  # fmt: skip
    there = np.isfinite(spectra)
    patterns, which = np.unique(there, axis=0, return_inverse=True)
    done = 0
    for number, pattern in enumerate(patterns):
        rows = np.flatnonzero(which.reshape(-1) == number)
        if pattern.sum() >= count:
            before = done

            def report(part: int, _: int, before: int = before) -> None:
                progress(before + part, len(spectra), "fitting")

            progress(done, len(spectra), "fitting")
            found = fit_spectra(
                spectra[np.ix_(rows, pattern)], wavelengths[pattern], specular=specular,
                progress=report,
            )  # fmt: skip
            result.parameters[rows], result.sigma[rows] = found.parameters, found.sigma
            result.covariance[rows], result.rmse[rows] = found.covariance, found.rmse
            result.model[np.ix_(rows, pattern)] = found.model
        done += len(rows)
    return result
