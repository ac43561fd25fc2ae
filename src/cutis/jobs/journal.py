"""The folder of a simulation in the making: a file per finished batch, so that none is lost.

Beside the result NAME lies NAME.parts with `run.json`, all that the result depends on, and
000000.npy, 000001.npy, …, each whole or not there. A run that was stopped, however rudely, goes on
with the batches that are missing; a run with other settings is refused.
"""

import contextlib
import hashlib
import json
import re
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import SkinSimulation, TensorSimulation
from cutis.errors import CutisError
from cutis.textures import replacing, sweep

Simulation = SkinSimulation | TensorSimulation
_BATCH = re.compile(r"^\d{6,}\.npy$")


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
        foreign = [path.name for path in self.folder.iterdir() if not _is_ours(path)]
        if foreign:
            raise CutisError(
                f"{self.folder} holds {foreign[0]}, which is not of a simulation; move it away, or "
                "give another name with -o"
            )
        if note.is_file():
            try:
                stored = json.loads(note.read_text("utf-8"))
            except (ValueError, RecursionError, OSError):
                stored = None
            if not isinstance(stored, dict):
                raise CutisError(f"{note} is damaged; remove the folder {self.folder.name}")
            changed = [key for key in wanted if stored.get(key) != wanted[key]]
            if changed:
                raise CutisError(
                    f"{self.folder.name} holds a simulation with another {', '.join(changed)}; "
                    "give the same options to go on with it, or remove that folder"
                )
        else:
            with replacing(note) as partial:
                partial.write_text(json.dumps(wanted, indent=2) + "\n", encoding="utf-8")
        sweep(self.folder)  # of a process that was killed while it wrote

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
        """Removes what is ours, and the folder if nothing else is in it."""
        with contextlib.suppress(OSError):
            for path in self.folder.iterdir():
                if _is_ours(path):
                    path.unlink(missing_ok=True)
            self.folder.rmdir()

    def _file(self, number: int) -> Path:
        return self.folder / f"{number:06d}.npy"


def _is_ours(path: Path) -> bool:
    """Whether a file has a name of the journal, or is one in the making."""
    return path.is_file() and (
        path.name == "run.json" or bool(_BATCH.match(path.name)) or path.name.startswith(".")
    )
