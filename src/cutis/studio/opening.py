"""A face opened: its colours at all sizes at once, its maps as soon as they are estimated."""

import contextlib
import threading
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.inverse import Model
from cutis.inverse.calibration import Exposure, White
from cutis.jobs import CaptureFiles, EstimateJob
from cutis.looks import Look
from cutis.maps import Face, MapsFile, find_source, load_model, open_source
from cutis.maps.changes import Change
from cutis.maps.estimating import Progress, nobody
from cutis.studio.levels import Level, Levels
from cutis.studio.projects import project_folder
from cutis.textures import TextureFile

KEPT = 16
"""Looks that stay ready for a level."""


@dataclass(frozen=True)
class Opening:
    """What is to be opened: a capture, or maps NAME.skin.exr, and how a capture is estimated.

    What is `bundled` with cutis gets no files beside it. A `look` takes the place of the one that
    was last worked on.
    """

    path: Path
    mask: Path | None = None
    white: White = "none"
    exposure: Exposure = "none"
    model: Model | None = None
    colorspace: Space | None = None
    bundled: bool = False
    look: Look | None = None

    @property
    def is_maps(self) -> bool:
        """Whether it is a file of maps."""
        return self.path.name.endswith(".skin.exr")

    def capture(self) -> Path:
        """The capture; CutisError where maps do not lead to one."""
        if not self.is_maps:
            return self.path
        with MapsFile(self.path) as file:
            if file.header.edits or file.header.changed:
                raise CutisError(
                    f"{self.path.name} holds edits already; open the capture, or the maps that "
                    "estimate wrote, and add the look there"
                )
            return find_source(file.provenance, self.path)


class OpenFace:
    """A face that is open: close it, or use it in a with block.

    `capture` is its file, `folder` that of its project, `maps` the file of its maps, which is there
    once `estimate` has run.
    """

    def __init__(self, opening: Opening) -> None:
        """Reads the colours; CutisError where the file is no face."""
        self.opening, self.capture = opening, opening.capture()
        self.folder = project_folder(opening.path, not opening.bundled)
        self._stack = contextlib.ExitStack()
        texture = self._stack.enter_context(self._texture())
        self.space, self.origin = texture.space, texture.origin
        self.channels, self.notes = texture.channels, list(texture.notes)
        self.stored = texture.rows(slice(0, 0)).pixels.dtype
        self.levels = Levels(texture, self.folder)
        self._file: MapsFile | None = None
        self._reading = threading.Lock()
        self._changes: OrderedDict[tuple[int, str], Change] = OrderedDict()

    def _texture(self) -> TextureFile:
        if not self.opening.is_maps:
            return TextureFile(self.capture, self.opening.colorspace or "auto")
        with MapsFile(self.opening.path) as file:
            return open_source(file.provenance, self.capture)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in texels."""
        return self.levels.shape

    @property
    def ready(self) -> bool:
        """Whether the maps are there."""
        return self._file is not None

    @property
    def maps(self) -> Path:
        """The file of maps."""
        if self.opening.is_maps:
            return self.opening.path
        return self.folder / f"{self.capture.stem}.skin.exr"

    @property
    def file(self) -> MapsFile:
        """The maps, open."""
        if self._file is None:
            raise CutisError("the maps are still being estimated; wait a moment")
        return self._file

    def estimate(self, progress: Progress = nobody) -> None:
        """Estimates the maps, if nobody has yet, and reads them; CutisError where that fails."""
        asked = self.opening
        if not asked.is_maps:
            job = EstimateJob(
                (CaptureFiles(self.capture, asked.mask),), self.folder, asked.white, asked.exposure,
                model=asked.model or load_model(), colorspace=asked.colorspace, again=True,
            )  # fmt: skip
            if not self._there(job):
                (found,) = job.run(progress)
                if found.failure is not None:
                    raise CutisError(found.failure)
        progress(0, 1, "reading maps")
        file = self._stack.enter_context(MapsFile(self.maps))
        if file.shape != self.shape:
            raise CutisError(f"{self.maps.name} is {file.shape}, its capture {self.shape}")
        self.levels.add_maps(file)
        self._file = file

    def _there(self, job: EstimateJob) -> bool:
        """Whether what the job would make is there already, of the same contents."""
        (capture,) = job.captures
        return job.found(capture, {**job.shared(), **job.own(capture)}).same

    # what looks are here ----------------------------------------------------------------------

    @property
    def model(self) -> Model:
        """The model of the maps."""
        return self.file.made_by.load()

    def change(self, look: Look, level: Level) -> Change:
        """The change that a look is on a level; CutisError where it does not fit this face."""
        key = (level.number, look.document)
        if key not in self._changes:
            ready = look.for_face(Face(level))
            self._changes[key] = ready
            while len(self._changes) > KEPT:
                self._changes.popitem(last=False)
        return self._changes[key]

    def sigmas(self, row: int) -> Any:
        """σ and confidence of a row, as its file has them."""
        with self._reading:
            return self.file.rows(slice(row, row + 1))

    def close(self) -> None:
        """Lets go of files and memory."""
        self._stack.close()
        self._file = None
        self._changes.clear()
        self.levels.close()

    def __enter__(self) -> "OpenFace":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
