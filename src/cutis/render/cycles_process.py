"""Pictures rendered by Cycles, all of a call in one Blender process.

The process is told by a JSON file and answers in lines (see `cutis/data/blender/scene.py`). It
writes into a folder of its own; what is finished is then put in its place whole.
"""

import collections
import json
import os
import shutil
import signal
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib import resources
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.render.blender import Blender, find_blender
from cutis.render.confined import PATIENCE, end, spoken, started, words
from cutis.render.scene import Scene
from cutis.textures.atomic import replacing
from cutis.textures.scratch import scratch_folder

_SLOW = 2e-5  # seconds more for each pixel that samples may take
_KEPT = 2000  # lines of its output that are kept for the log of a failure

Progress = Callable[[int, int, str], None]
"""Told (samples done, samples in all, the picture's name) while a job runs."""


def render(
    pictures: Sequence[tuple[Scene, Path]],
    blender: Blender | None = None,
    progress: Progress | None = None,
    finished: Callable[[Path], None] | None = None,
    note: Callable[[str], None] | None = None,
) -> str:
    """Renders scenes into EXR files, float, linear Rec.709, and returns the device's name.

    pictures: scenes and the files to write. Neighbours that share a mesh or textures save loading
    them again. blender: by default `find_blender()`. finished: called with each file once it is
    whole; what it raises ends the job, as an interrupt does, and Blender with it. note: told what
    people should know, such as parts of the mesh that the texture does not cover.

    Raises CutisError where Blender is missing or fails, or a mesh or texture cannot be used; the
    pictures finished before stay.
    """
    if not pictures:
        return ""
    for _, path in pictures:
        if path.suffix.lower() != ".exr":
            raise CutisError(f"{path}: pictures are rendered into .exr files")
        if not path.parent.is_dir():
            raise CutisError(f"{path}: the folder {path.parent} does not exist; create it first")
    blender = blender or find_blender()
    with scratch_folder() as folder:
        jobs = [scene.job(folder / f"{i}.exr") for i, (scene, _) in enumerate(pictures)]
        (folder / "job.json").write_text(json.dumps({"pictures": jobs}))
        script = resources.files("cutis.data").joinpath("blender", "scene.py")
        with resources.as_file(script) as file:
            command = blender.command(file, str(folder / "job.json"))
            return _run(command, folder, pictures, progress, finished, note)


def _run(
    command: list[str],
    folder: Path,
    pictures: Sequence[tuple[Scene, Path]],
    progress: Progress | None,
    finished: Callable[[Path], None] | None,
    note: Callable[[str], None] | None,
) -> str:
    process = started(command, folder)
    total = sum(scene.samples for scene, _ in pictures)
    before, current, device = 0, 0, ""
    said: collections.deque[str] = collections.deque(maxlen=_KEPT)
    try:
        if progress:
            progress(0, total, "starting Blender")
        largest = max(scene.width * scene.height for scene, _ in pictures)
        for text in spoken(process, PATIENCE + _SLOW * largest):
            event = _event(text)
            if event is None:
                if text:
                    said.append(text)
                continue
            kind, current = event["event"], event.get("picture", current)
            scene, path = pictures[current]
            if kind == "error":
                raise CutisError(words(event["message"]))
            if kind == "note" and note:
                note(words(event["message"]))
            elif kind == "device":
                device = event["name"]
            elif kind == "sample" and progress:
                progress(min(before + event["sample"], total), total, path.stem)
            elif kind == "done":
                rendered = folder / f"{current}.exr"
                with replacing(path) as temporary:
                    shutil.copyfile(rendered, temporary)
                rendered.unlink()
                before, current = before + scene.samples, min(current + 1, len(pictures) - 1)
                if finished:
                    finished(path)
                if progress:
                    progress(before, total, path.stem)
        status = process.wait()
        if before != total:  # a crash after the last picture is none
            raise _failure(status, current, len(pictures), said)
        return device
    finally:
        end(process)


def _event(line: str) -> dict[str, Any] | None:
    """What the script says in a line; None for what Blender says."""
    if not line.startswith("CUTIS "):
        return None
    with suppress(ValueError):
        event = json.loads(line[6:])
        if isinstance(event, dict) and "event" in event:
            return event
    return None


def _failure(status: int, number: int, count: int, said: Sequence[str]) -> CutisError:
    """One line about a process that ended without saying why; all it said goes to a file."""
    where = f"picture {number + 1} of {count}"
    descriptor, log = tempfile.mkstemp(prefix="cutis-blender-", suffix=".log")
    with os.fdopen(descriptor, "w", encoding="utf-8", errors="replace") as file:
        file.writelines(f"{line}\n" for line in said)
    if -status == getattr(signal, "SIGKILL", 9):
        return CutisError(
            f"Blender was killed at {where}, most likely for want of memory; render it smaller or "
            f"with smaller textures (what Blender said: {log})"
        )
    how = f"status {status}"
    if status < 0:
        with suppress(ValueError):
            how = signal.Signals(-status).name
    last = said[-1].strip() if said else "nothing"
    return CutisError(
        f"Blender ended at {where} without a picture ({how}); its last words: {last[:200]} "
        f"(all of them: {log})"
    )
