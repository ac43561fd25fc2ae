"""One face at work: what is open, its state, and who looks at it."""

import json
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.jobs import EditJob
from cutis.looks import Look
from cutis.maps.estimating import Progress, nobody
from cutis.studio.drawing import Drawer
from cutis.studio.history import History
from cutis.studio.opening import OpenFace, Opening
from cutis.studio.projects import output_name
from cutis.studio.state import Op, State

HISTORY = "history.sqlite"
LOOK = ".look.json"


@dataclass(frozen=True)
class Saved:
    """What was written, and the command that does the same."""

    path: Path
    command: str
    changed: int = 0
    notes: tuple[str, ...] = ()


class Workshop:
    """An open face with its history; methods may be called from any thread.

    `watchers` are called, with the revision, after every change of the state.
    """

    def __init__(self, opening: Opening) -> None:
        """Opens the face and its history; maps come with `estimate`."""
        self.face = OpenFace(opening)
        try:
            self.history = History(self.face.folder / HISTORY)
        except BaseException:
            self.face.close()
            raise
        self.drawer = Drawer(self.face)
        self.watchers: list[Callable[[], None]] = []
        self._lock, self._saving = threading.Lock(), threading.Lock()
        self.number, self.state = self.history.now()
        if opening.look is not None and opening.look != self.state.look:
            self.state = State.of(opening.look)
            self.number = self.history.push(self.state, f"Loaded {opening.look.name}".strip())
        self.revision = 0

    def estimate(self, progress: Progress = nobody) -> None:
        """Estimates the maps where they are not there; see `OpenFace.estimate`."""
        self.face.estimate(progress)

    # the state --------------------------------------------------------------------------------

    def check(self, state: State) -> None:
        """CutisError where the look does not fit this face."""
        if self.face.ready:
            self.face.change(state.look, self.face.levels.all[-1])

    def do(self, op: Op, what: str) -> State:
        """Does something to the state; it is on disk when this returns."""
        with self._lock:
            state = self.state.after(op)
            self.check(state)
            if state == self.state:
                return state
            self._now(self.history.push(state, what[:200]), state)
        self._tell()
        return state

    def step(self, by: int) -> State:
        """Undoes (-1) or does again (1)."""
        with self._lock:
            self._now(*self.history.step(by))
        self._tell()
        return self.state

    def go(self, number: int) -> State:
        """A state of the history."""
        with self._lock:
            self._now(*self.history.go(number))
        self._tell()
        return self.state

    def _now(self, number: int, state: State) -> None:
        self.number, self.state = number, state
        self.revision += 1

    def _tell(self) -> None:
        for watcher in list(self.watchers):
            watcher()

    def told(self) -> dict[str, Any]:
        """The state for a page."""
        undo, redo = self.history.ends()
        return {
            **self.state.as_json(), "revision": self.revision, "number": self.number,
            "undo": undo, "redo": redo,
        }  # fmt: skip

    # out --------------------------------------------------------------------------------------

    @property
    def stem(self) -> str:
        """How names of outputs start."""
        return self.face.capture.stem

    @property
    def folder(self) -> Path:
        """Where outputs go: beside the face, or where the studio was started."""
        beside = self.face.opening.path.parent
        return beside if self.face.folder.parent == beside else Path.cwd()

    def whole_look(self, look: Look) -> Look:
        """The look as a document to keep: its numbers are of the tissue of the maps."""
        if look.tissue is not None:
            return look
        return look.model_copy(update={"tissue": self.face.model.tissue.name})

    def save(self, label: str, progress: Progress = nobody) -> Saved:
        """Writes the edited albedo in format, depth and space of the capture, and its look beside.

        Both get new names. The bytes are those of `cutis edit MAPS --look LOOK -o OUTPUT`.
        """
        self.face.file  # noqa: B018 - says that maps are not there yet
        with self._saving:
            look = self.whole_look(self.state.look)
            output = output_name(self.folder, self.stem, label, self.face.capture.suffix)
            beside = output.with_name(f"{output.stem}{LOOK}")
            look.save(beside)
            try:
                (done,) = EditJob(self.face.maps, output, look).run(progress)
            except BaseException:
                beside.unlink(missing_ok=True)
                raise
        return Saved(output, self.command(beside, output), done.changed, done.notes)

    def save_look(self, label: str) -> Saved:
        """Writes the look alone."""
        with self._saving:
            path = output_name(self.folder, self.stem, label, LOOK)
            self.whole_look(self.state.look).save(path)
        return Saved(path, self.command(path, self.folder / f"{self.stem}.{label}.png"))

    def command(self, look: Path, output: Path) -> str:
        """The `cutis` line that does the same as this page."""
        import shlex

        return shlex.join([
            "cutis", "edit", str(self.face.maps), "--look", str(look), "-o", str(output)
        ])  # fmt: skip

    def close(self) -> None:
        """Lets go of everything."""
        self.history.close()
        self.face.close()


def document_of(state: State) -> str:
    """The look of a state as text, to be copied."""
    return json.dumps(json.loads(state.look.document), indent=2, ensure_ascii=False)


def no_face(path: Path, error: Exception) -> CutisError:
    """What to raise where a file is none that can be opened."""
    return error if isinstance(error, CutisError) else CutisError(f"{path.name}: {error}")
