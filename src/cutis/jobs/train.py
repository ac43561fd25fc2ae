"""Networks trained and inverses baked: what ships, and people's own."""

import csv
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.inverse import shipped
from cutis.inverse.baked import (
    ALIAGA_CHART,
    MEASURED_CHART,
    bake,
    exact_inverse,
    probable_skins,
    save_baked,
)
from cutis.inverse.trust import TRUST_CHART, trust_of
from cutis.jobs.files import make_folder
from cutis.jobs.job import digest_of
from cutis.maps.estimating import Progress, nobody
from cutis.textures import replacing

BAKED = tuple(shipped.TISSUE_OF)
"""Recipes that bake a table instead of training networks."""


@dataclass(frozen=True)
class Trained:
    """The files that were written, and the metrics of a training."""

    files: tuple[Path, ...]
    metrics: dict[str, Any] | None = None


@dataclass(frozen=True)
class TrainJob:
    """A recipe by name, the folder of its run, and epochs instead of the recipe's."""

    recipe: str = "aliaga2022"
    folder: Path = field(default=Path("runs"), metadata={"result": False})
    epochs: int | None = None

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> Trained:
        """Trains, going on with a run that was stopped, or bakes."""
        if self.recipe in BAKED:
            make_folder(self.folder)
            return Trained(tuple(_bake(self.recipe, self.folder, progress)))
        try:
            from cutis.inverse.training import RECIPES, train
        except ModuleNotFoundError as error:
            raise CutisError(
                f"training needs PyTorch ({error.name} is missing); pip install 'cutis[train]'"
            ) from None
        if self.recipe not in RECIPES:
            known = ", ".join((*BAKED, *RECIPES))
            raise CutisError(f"unknown recipe {self.recipe!r}; known are {known}")
        make_folder(self.folder)
        chosen = RECIPES[self.recipe]
        if self.epochs is not None:
            chosen = replace(chosen, epochs=self.epochs)
        metrics = train(
            chosen, self.folder,
            lambda done, all_, loss: progress(done, all_, f"loss {loss:.5f}"),
        )  # fmt: skip
        _plot(self.folder)
        return Trained((self.folder / "weights.safetensors",), metrics)


def _bake(recipe: str, folder: Path, progress: Progress) -> list[Path]:
    """Writes the tables of a baked model; returns their names."""
    jobs: dict[str, tuple[Callable[..., Any], Any]]
    if recipe == shipped.EXACT:
        space = albedo_space(shipped.TISSUE_OF[recipe])
        jobs = {recipe: (exact_inverse(shipped.shipped_encoder(), space), ALIAGA_CHART)}
    else:
        space, prior = albedo_space(shipped.TISSUE_OF[recipe]), shipped.shipped_prior(recipe)
        jobs = {
            recipe: (probable_skins(prior, space), MEASURED_CHART),
            f"{recipe}-trust": (trust_of(prior, space), TRUST_CHART),
        }
    written = []
    for name, (solve, chart) in jobs.items():
        told = f"baking {name}"

        def say(done: int, total: int, told: str = told) -> None:
            progress(done, total, told)

        baked = bake(solve, chart, say)
        written.append(folder / f"{name}.npz")
        with replacing(written[-1]) as partial:
            save_baked(baked, partial)
    return written


def _plot(folder: Path) -> None:
    from matplotlib.figure import Figure

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
