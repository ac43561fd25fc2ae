"""`cutis train`: the weights and the baked inverse that ship, and your own."""

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
    from cutis.apps.console import bar, out
    from cutis.jobs.train import TrainJob

    with bar(quiet) as progress:
        found = TrainJob(recipe, output or Path("runs") / recipe, epochs).run(progress)
    if quiet:
        return
    if found.metrics is not None:
        out.print_json(data=found.metrics)
    out.say(f"wrote {' and '.join(str(path) for path in found.files)}")
