"""`cutis train`: the weights and the baked inverse that ship, and your own."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def train(
    recipe: Annotated[
        str,
        typer.Argument(
            help="aliaga2022, aliaga2022-mean, smoke; measured2026 and aliaga2022-exact are baked."
        ),
    ] = "aliaga2022",
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder of the run; runs/RECIPE if absent."),
    ] = None,
    epochs: Annotated[int | None, typer.Option(min=1, help="Instead of the recipe's.")] = None,
    quiet: options.Quiet = False,
) -> None:
    """Train encoder and decoder, or bake an inverse.

    A run that was stopped goes on where its last checkpoint was when the same command is given
    again. Writes weights.safetensors, metrics.json, curves.csv and curves.png; for those that are
    baked, RECIPE.npz, and for `measured2026`, from the prior that ships, measured2026-trust.npz.

    Example: cutis train aliaga2022 -o runs/aliaga2022
    """
    from cutis.apps.console import out, steps
    from cutis.errors import CutisError
    from cutis.inverse.models import EXACT, MEASURED

    folder = output or Path("runs") / recipe
    if recipe in (EXACT, MEASURED):
        options.make_folder(folder)
        with steps(1, quiet) as progress:
            written = _bake(recipe, folder, progress.at)
        if not quiet:
            out.print(f"wrote {' and '.join(str(path) for path in written)}")
        return

    try:
        from cutis.inverse.training import RECIPES
        from cutis.inverse.training import train as run
    except ModuleNotFoundError as error:
        raise CutisError(
            f"training needs PyTorch ({error.name} is missing); pip install 'cutis[train]'"
        ) from None
    if recipe not in RECIPES:
        raise CutisError(
            f"unknown recipe {recipe!r}; known are {MEASURED}, {EXACT}, {', '.join(RECIPES)}"
        )
    from dataclasses import replace

    options.make_folder(folder)
    chosen = RECIPES[recipe] if epochs is None else replace(RECIPES[recipe], epochs=epochs)
    with steps(chosen.epochs, quiet) as progress:
        metrics = run(
            chosen, folder, lambda done, all_, loss: progress.at(done, all_, f"loss {loss:.5f}")
        )
    _plot(folder)
    if not quiet:
        out.print_json(data=metrics)
        out.print(f"wrote {folder / 'weights.safetensors'}")


def _bake(recipe: str, folder: Path, at: Callable[[int, int, str], None]) -> list[Path]:
    """Writes the tables of a baked model; returns their names."""
    from cutis.albedo import albedo_space
    from cutis.inverse.baked import (
        ALIAGA_CHART,
        MEASURED_CHART,
        bake,
        exact_inverse,
        probable_skins,
        save_baked,
    )
    from cutis.inverse.models import EXACT, shipped_encoder, shipped_prior, tissue_of
    from cutis.inverse.trust import TRUST_CHART, trust_of
    from cutis.textures import replacing

    if recipe == EXACT:
        jobs = {recipe: (exact_inverse(shipped_encoder()), ALIAGA_CHART)}
    else:
        space, prior = albedo_space(tissue_of(recipe)), shipped_prior()
        jobs = {
            recipe: (probable_skins(prior, space), MEASURED_CHART),
            f"{recipe}-trust": (trust_of(prior, space), TRUST_CHART),
        }
    written = []
    for name, (solve, chart) in jobs.items():
        told = f"baking {name}"

        def say(done: int, total: int, told: str = told) -> None:
            at(done, total, told)

        baked = bake(solve, chart, say)
        written.append(folder / f"{name}.npz")
        with replacing(written[-1]) as partial:
            save_baked(baked, partial)
    return written


def _plot(folder: Path) -> None:
    import csv

    from matplotlib.figure import Figure

    from cutis.textures import replacing

    with (folder / "curves.csv").open() as file:
        rows = list(csv.DictReader(file))
    figure = Figure(figsize=(7, 4.2), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    for name in list(rows[0])[1:]:
        axes.semilogy(
            [int(row["epoch"]) for row in rows],
            [float(row[name]) for row in rows],
            label=name.replace("_", " "),
        )
    axes.set(xlabel="epoch", ylabel="loss")
    axes.legend()
    with replacing(folder / "curves.png") as partial:
        figure.savefig(partial)
