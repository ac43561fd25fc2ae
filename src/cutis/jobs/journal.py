"""The folder of a simulation in the making: a file per finished batch, so that none is lost.

Beside the result NAME lies NAME.parts with `run.json`, all that the result depends on, and
000000.npy, 000001.npy, …, each whole or not there. A run that was stopped, however rudely, goes on
with the batches that are missing; a run with other settings is refused.
"""

import hashlib
import json
import shutil
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import SkinSimulation, TensorSimulation
from cutis.errors import CutisError
from cutis.textures import replacing

Simulation = SkinSimulation | TensorSimulation


def settings(simulation: Simulation) -> dict[str, Any]:
    """All that the result depends on, as JSON holds it; skins by their digest."""
    found = asdict(simulation.walks)
    if isinstance(simulation, TensorSimulation):
        found["tensor"] = list(simulation.shape)
    else:
        skins = np.ascontiguousarray(simulation.skins, dtype="<f8")
        found["skins"] = len(skins)
        found["skins_sha256"] = hashlib.sha256(skins.tobytes()).hexdigest()
        found["batch"] = simulation.size
    return dict(json.loads(json.dumps(found)))


class Journal:
    """Finished batches of a simulation, in the folder beside its result."""

    def __init__(self, simulation: Simulation, result: Path) -> None:
        """Opens or makes the folder; CutisError where it holds a simulation of another kind."""
        self.folder = result.with_name(f"{result.name}.parts")
        self.count = simulation.batches
        wanted, note = settings(simulation), self.folder / "run.json"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise CutisError(
                f"{self.folder}: cannot make this folder ({(error.strerror or '').lower()})"
            ) from error
        if note.is_file():
            try:
                stored = json.loads(note.read_text("utf-8"))
            except ValueError:
                stored = {}
            changed = [key for key in wanted if stored.get(key) != wanted[key]]
            if changed:
                raise CutisError(
                    f"{self.folder.name} holds a simulation with another {', '.join(changed)}; "
                    "give the same options to go on with it, or remove that folder"
                )
        else:
            with replacing(note) as partial:
                partial.write_text(json.dumps(wanted, indent=2) + "\n", encoding="utf-8")
        for left in self.folder.glob(".*"):  # of a process that was killed while it wrote
            left.unlink(missing_ok=True)

    def missing(self) -> list[int]:
        """Numbers of the batches that are not there yet."""
        return [number for number in range(self.count) if not self._file(number).is_file()]

    def put(self, number: int, values: NDArray[np.float64]) -> None:
        """Keeps a finished batch."""
        with replacing(self._file(number)) as partial, partial.open("wb") as file:
            np.save(file, values, allow_pickle=False)

    def parts(self) -> Iterator[NDArray[np.float64]]:
        """The batches in order, once all are there; CutisError names one that is damaged."""
        for number in range(self.count):
            try:
                yield np.load(self._file(number), allow_pickle=False)
            except (OSError, ValueError, EOFError) as error:
                raise CutisError(
                    f"{self._file(number)} is damaged; remove it and simulate again"
                ) from error

    def discard_empty(self) -> None:
        """Removes the folder if no batch is in it."""
        if len(self.missing()) == self.count:
            self.remove()

    def remove(self) -> None:
        """Removes the folder, once its result is written."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _file(self, number: int) -> Path:
        return self.folder / f"{number:06d}.npy"
