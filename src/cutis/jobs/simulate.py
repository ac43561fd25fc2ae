"""Skins walked through by photons: batches that are kept as they finish, and the result."""

import csv
import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import TensorSimulation, albedo_space
from cutis.colour import reflectance_to_rgb
from cutis.errors import CutisError
from cutis.inverse.model import content_digest
from cutis.jobs.journal import Journal, Simulation, settings
from cutis.jobs.results import alone
from cutis.jobs.runners import Runner, cluster, here
from cutis.maps.estimating import Progress, nobody
from cutis.optics import NAMES, WAVELENGTHS
from cutis.textures import replacing

MOST_CHECKED = 100_000
"""Skins that are compared with the exact solver."""


@dataclass(frozen=True)
class Simulated:
    """What came of it: how many skins, the largest standard error, and lines on how right it is."""

    skins: int
    worst_error: float
    notes: tuple[str, ...] = ()
    gone_on: int = 0


@dataclass(frozen=True)
class SimulateJob:
    """A simulation, its result (.csv, or .npz for many skins), where to compute.

    `single` writes a row per wavelength instead of one per skin. `scheduler` is the address of a
    Dask scheduler, None to work here. A simulation that was stopped goes on where it was.
    """

    simulation: Simulation
    output: Path = field(metadata={"result": False})
    single: bool = False
    device: str = "cpu"
    scheduler: str | None = field(default=None, metadata={"result": False})

    def __post_init__(self) -> None:
        if self.output.suffix.lower() not in (".csv", ".npz"):
            raise CutisError(f"{self.output}: end its name in .csv or .npz")

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return content_digest(settings(self.simulation), self.single)

    def run(self, progress: Progress = nobody) -> Simulated:
        """Computes what is missing and writes the result."""
        simulation = self.simulation
        with alone(self.output):
            journal = Journal(simulation, self.output)
            done = journal.count - len(journal.missing())
            try:
                self._compute(journal, progress)
            finally:
                journal.discard_empty()
            reflectance, error = simulation.assemble(list(journal.parts()))
            self._write(reflectance, error)
            journal.remove()
        notes = _compared(simulation, reflectance, error)
        return Simulated(len(reflectance), float(error.max()), notes, done)

    def _compute(self, journal: Journal, progress: Progress) -> None:
        missing = journal.missing()
        done = journal.count - len(missing)

        def counted(part: int, whole: int, doing: str) -> None:
            share = done + len(missing) * part / max(whole, 1)
            progress(int(1000 * share), 1000 * journal.count, doing)

        runner: Runner = here if self.scheduler is None else cluster(self.scheduler)
        work = _Batch(self.simulation, self.device)
        for number, values in runner(work, missing, counted):
            if isinstance(values, Exception):
                raise CutisError(f"batch {number} failed: {values}")
            journal.put(number, values)

    def _write(self, reflectance: NDArray[np.float64], error: NDArray[np.float64]) -> None:
        simulation = self.simulation
        if self.output.suffix.lower() == ".npz":
            with replacing(self.output) as partial, partial.open("wb") as file:
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
        if self.single:
            rows = [["wavelength_nm", "reflectance", "standard_error"]]
            for band, value, sigma in zip(bands, reflectance[0], error[0], strict=True):
                rows.append([band, f"{value:.8f}", f"{sigma:.3e}"])
        else:
            rows = [[*NAMES, *bands, *(f"se_{band}" for band in bands)]]
            for skin, values, sigmas in zip(simulation.skins, reflectance, error, strict=True):
                cells = [f"{v:.8g}" for v in skin] + [f"{v:.8f}" for v in values]
                rows.append(cells + [f"{v:.3e}" for v in sigmas])
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        with replacing(self.output) as partial:
            partial.write_text(text.getvalue(), encoding="utf-8")


@dataclass(frozen=True)
class _Batch:
    """One batch of a simulation, wherever it is computed."""

    simulation: Simulation
    device: str

    def __call__(self, number: int, progress: Progress) -> Any:
        def within(part: int, whole: int) -> None:
            progress(part, whole, "walking")

        return self.simulation.compute(number, self.device, within)


def _compared(
    simulation: Simulation, reflectance: NDArray[np.float64], error: NDArray[np.float64]
) -> tuple[str, ...]:
    """How far the walk is from the exact solver, in its own standard errors."""
    if simulation.walks.incidence != "lambertian" or len(reflectance) > MOST_CHECKED:
        return ()
    with np.errstate(divide="ignore", invalid="ignore"):
        exact = albedo_space(simulation.walks.tissue).reflectance(simulation.skins)
        z = np.where(error > 0, (reflectance - exact) / error, 0.0)
    if not np.isfinite(z).all():
        return ()
    from scipy.stats import norm

    bound = norm.isf(0.005 / z.size)
    alike = ", whose errors are alike" if isinstance(simulation, TensorSimulation) else ""
    return (
        f"exact solver: rms of z {np.sqrt(np.mean(z**2)):.2f}, largest {np.abs(z).max():.2f} "
        f"(1 % of right walks exceed {bound:.2f} over {z.size} values{alike})",
    )
