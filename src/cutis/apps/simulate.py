"""`cutis simulate`: skins walked through by photons, with the error of every albedo."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.jobs.journal import Simulation


@options.parameter_values
def simulate(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Result: .csv, or .npz for many skins.")
    ],
    values: options.Values,
    skins: options.Skins = None,
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
    cluster: options.Cluster = None,
    quiet: options.Quiet = False,
) -> None:
    """Simulate skins by Monte Carlo walks: reflectance 380-780 nm with its standard error.

    A simulation that was stopped goes on where it was when the same command is given again. One
    skin gives the columns wavelength_nm,reflectance,standard_error; many give a row per skin
    (.csv) or arrays (.npz).

    Example: cutis simulate --melanin 0.02 --blood 0.01 --photons 100000 -o skin.csv
    """
    from dataclasses import replace

    from cutis.albedo import Walks
    from cutis.apps.console import bar, out
    from cutis.jobs.simulate import SimulateJob
    from cutis.optics import ALIAGA2022

    tissue = replace(ALIAGA2022, dimension=dimension, boundary=boundary)
    if tissue != ALIAGA2022:
        tissue = replace(tissue, name=f"aliaga2022-{dimension}d-{boundary}")
    walks = Walks(tissue, photons, seed, options.incidence(incidence))
    simulation = _chosen(walks, values, skins, grid, dataset, tensor)
    single = skins is None and grid is None and len(simulation.skins) == 1
    job = SimulateJob(simulation, output, single, device, cluster)
    with bar(quiet) as progress:
        found = job.run(progress)
    if quiet:
        return
    if found.gone_on:
        out.say(f"went on after {found.gone_on} of {simulation.batches} batches")
    out.say(f"wrote {output}: {found.skins} skins, standard error at most {found.worst_error:.1e}")
    for note in found.notes:
        out.say(note)


def _chosen(
    walks: Any, values: options.Values, skins: Path | None, grid: str | None, dataset: int | None,
    tensor: str | None,
) -> "Simulation":  # fmt: skip
    """The skins that flags mean, as a simulation."""
    import numpy as np

    from cutis.albedo import SkinSimulation, TensorSimulation, grid_skins, halton
    from cutis.errors import CutisError
    from cutis.jobs.spectrum import read_skins
    from cutis.optics import RARE_NAMES, skin

    if rare := [name for name in values if name in RARE_NAMES]:
        raise CutisError(f"{rare[0]} is not simulated; leave the flag out")
    if (
        sum((skins is not None, bool(values), *(x is not None for x in (grid, dataset, tensor))))
        > 1
    ):
        raise CutisError(
            "give one of: a CSV of skins, parameter flags, --grid, --dataset, --tensor"
        )
    if tensor is not None:
        return TensorSimulation(options.sizes(tensor, "tensor"), walks)
    if dataset is not None and dataset < 1:
        raise CutisError(f"--dataset {dataset}: a data set needs at least one skin")
    if skins is not None:
        chosen = read_skins(skins)[2]
    elif grid is not None:
        chosen = grid_skins(options.sizes(grid, "grid"))
    elif dataset is not None:
        chosen = np.asarray(halton(dataset, walks.seed), dtype=np.float64)
    else:
        chosen = skin(values)[None]
    return SkinSimulation(chosen, walks)
