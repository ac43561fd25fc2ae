"""`cutis simulate`: skins walked through by photons, with the error of every albedo."""

import csv
import io
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cutis.apps import options

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from cutis.jobs.journal import Simulation

MOST_CHECKED = 100_000
"""Skins that are compared with the exact solver."""


def simulate(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Result: .csv, or .npz for many skins.")
    ],
    skins: options.Skins = None,
    melanin: options.Melanin = None,
    blood: options.Blood = None,
    thickness: options.Thickness = None,
    eumelanin: options.Eumelanin = None,
    oxygenation: options.Oxygenation = None,
    grid: Annotated[
        str | None, typer.Option(help="Five sizes of a grid over the parameters: 8,8,3,1,1.")
    ] = None,
    dataset: Annotated[
        int | None, typer.Option(help="Number of skins spread over the albedo space (Halton).")
    ] = None,
    tensor: Annotated[
        str | None,
        typer.Option(
            help="A grid like 64,32,3,3,3, all absorptions of a band from one set of paths."
        ),
    ] = None,
    photons: Annotated[int, typer.Option(help="Photons per skin and wavelength.")] = 1_000_000,
    seed: Annotated[int, typer.Option(help="Same seed, same answer.")] = 0,
    dimension: Annotated[int, typer.Option(help="2 (flatland, as in the paper) or 3.")] = 2,
    boundary: Annotated[str, typer.Option(help="matched, or fresnel (n = 1.4).")] = "matched",
    incidence: Annotated[
        str, typer.Option(help="lambertian, or the cosine of a beam inside, above 0 to 1.")
    ] = "lambertian",
    device: Annotated[str, typer.Option(help="cpu, cuda, or auto.")] = "cpu",
    cluster: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, tcp://HOST:8786.")
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Simulate skins by Monte Carlo walks: reflectance 380-780 nm with its standard error.

    A simulation that was stopped goes on where it was when the same command is given again. One
    skin gives the columns wavelength_nm,reflectance,standard_error; many give a row per skin
    (.csv) or arrays (.npz).

    Example: cutis simulate --melanin 0.02 --blood 0.01 --photons 100000 -o skin.csv
    """
    import numpy as np

    from cutis.albedo import SkinSimulation, TensorSimulation, Walks, grid_skins, halton
    from cutis.apps.console import out
    from cutis.apps.spectrum import read_skins
    from cutis.errors import CutisError
    from cutis.jobs.journal import Journal
    from cutis.optics import ALIAGA2022, NAMES, skin

    flags = dict(zip(NAMES, (melanin, blood, thickness, eumelanin, oxygenation), strict=True))
    given = {name: value for name, value in flags.items() if value is not None}
    sources = [skins is not None, bool(given), grid is not None, dataset is not None,
               tensor is not None]  # fmt: skip
    if sum(sources) > 1:
        raise CutisError(
            "give one of: a CSV of skins, parameter flags, --grid, --dataset, --tensor"
        )
    if output.suffix.lower() not in (".csv", ".npz"):
        raise CutisError(f"{output}: end its name in .csv or .npz")
    tissue = replace(ALIAGA2022, dimension=dimension, boundary=boundary)
    if tissue != ALIAGA2022:
        tissue = replace(tissue, name=f"aliaga2022-{dimension}d-{boundary}")
    walks = Walks(tissue, photons, seed, _incidence(incidence))
    simulation: Simulation
    if tensor is not None:
        simulation = TensorSimulation(_sizes(tensor, "tensor"), walks)
    else:
        if skins is not None:
            chosen = read_skins(skins)[2]
        elif grid is not None:
            chosen = grid_skins(_sizes(grid, "grid"))
        elif dataset is not None:
            if dataset < 1:
                raise CutisError(f"--dataset {dataset}: a data set needs at least one skin")
            chosen = np.asarray(halton(dataset, seed), dtype=np.float64)
        else:
            chosen = skin(given)[None]
        simulation = SkinSimulation(chosen, walks)
    journal = Journal(simulation, output)
    try:
        _run(simulation, journal, device, cluster, quiet)
    finally:
        journal.discard_empty()
    reflectance, error = simulation.assemble(list(journal.parts()))
    single = len(reflectance) == 1 and skins is None and grid is None
    _write(output, simulation, reflectance, error, single)
    journal.remove()
    if not quiet:
        out.print(f"wrote {output}: {len(reflectance)} skins, standard error at most "
                  f"{error.max():.1e}")  # fmt: skip
        _compare(simulation, reflectance, error)


def _batch(number: int, simulation: "Simulation", device: str) -> Any:
    return simulation.compute(number, device)


def _run(
    simulation: "Simulation", journal: Any, device: str, cluster: str | None, quiet: bool
) -> None:
    """Computes what is missing, here or on a cluster."""
    from cutis.apps.console import out, steps
    from cutis.errors import CutisError
    from cutis.jobs.cluster import on_cluster

    missing = journal.missing()
    done = journal.count - len(missing)
    if done and not quiet:
        out.print(f"going on after {done} of {journal.count} batches")
    with steps(journal.count, quiet) as progress:
        progress.at(done, journal.count, "walking")
        if cluster is not None:
            for number, values in on_cluster(cluster, _batch, missing, simulation, device):
                if isinstance(values, Exception):
                    raise CutisError(f"batch {number} failed: {values}")
                journal.put(number, values)
                done += 1
                progress.at(done, journal.count, "walking")
            return
        for number in missing:
            before = done

            def within(part: int, whole: int, before: int = before) -> None:
                progress.at(1000 * before + 1000 * part // whole, 1000 * journal.count, "walking")

            journal.put(number, simulation.compute(number, device, within))
            done += 1


def _write(
    output: Path,
    simulation: "Simulation",
    reflectance: "NDArray[np.float64]",
    error: "NDArray[np.float64]",
    single: bool,
) -> None:
    import numpy as np

    from cutis.colour import reflectance_to_rgb
    from cutis.jobs.journal import settings
    from cutis.optics import NAMES, WAVELENGTHS
    from cutis.textures import replacing

    if output.suffix.lower() == ".npz":
        with replacing(output) as partial, partial.open("wb") as file:
            np.savez_compressed(
                file,
                parameters=simulation.skins,
                wavelengths=WAVELENGTHS,
                reflectance=reflectance,
                standard_error=error,
                rgb=reflectance_to_rgb(reflectance, WAVELENGTHS),
                settings=np.array(json.dumps(settings(simulation))),
            )
        return
    bands = [f"{lam:g}" for lam in WAVELENGTHS]
    rows: list[list[str]]
    if single:
        rows = [["wavelength_nm", "reflectance", "standard_error"]]
        for band, value, sigma in zip(bands, reflectance[0], error[0], strict=True):
            rows.append([band, f"{value:.8f}", f"{sigma:.3e}"])
    else:
        rows = [[*NAMES, *bands, *(f"se_{band}" for band in bands)]]
        for skin, values, sigmas in zip(simulation.skins, reflectance, error, strict=True):
            rows.append([f"{v:.8g}" for v in skin] + [f"{v:.8f}" for v in values]
                        + [f"{v:.3e}" for v in sigmas])  # fmt: skip
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    with replacing(output) as partial:
        partial.write_text(text.getvalue(), encoding="utf-8")


def _compare(
    simulation: "Simulation", reflectance: "NDArray[np.float64]", error: "NDArray[np.float64]"
) -> None:
    """Prints how far the walk is from the exact solver, in its own standard errors."""
    import numpy as np

    from cutis.albedo import TensorSimulation, albedo_space
    from cutis.apps.console import out

    if simulation.walks.incidence != "lambertian" or len(reflectance) > MOST_CHECKED:
        return
    with np.errstate(divide="ignore", invalid="ignore"):
        exact = albedo_space(simulation.walks.tissue).reflectance(simulation.skins)
        z = np.where(error > 0, (reflectance - exact) / error, 0.0)
    if not np.isfinite(z).all():
        return
    from scipy.stats import norm

    bound = norm.isf(0.005 / z.size)
    alike = ", whose errors are alike" if isinstance(simulation, TensorSimulation) else ""
    out.print(
        f"exact solver: rms of z {np.sqrt(np.mean(z**2)):.2f}, largest {np.abs(z).max():.2f} "
        f"(1 % of right walks exceed {bound:.2f} over {z.size} values{alike})"
    )


def _sizes(text: str, name: str) -> tuple[int, ...]:
    from cutis.errors import CutisError

    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise CutisError(
            f"--{name} takes five whole numbers like 8,8,3,1,1, not {text!r}"
        ) from None


def _incidence(text: str) -> float | str:
    from cutis.errors import CutisError
    from cutis.transport.quadrature import beam_cosine

    try:
        value: float | str = "lambertian" if text == "lambertian" else float(text)
    except ValueError:
        raise CutisError(
            f"--incidence takes lambertian or the cosine of a beam, not {text!r}"
        ) from None
    beam_cosine(value)
    return value
