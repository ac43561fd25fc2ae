"""Maps edited: from maps and capture to the edited albedo, in bands of rows."""

import contextlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from cutis.colour import Light, Space
from cutis.errors import CutisError
from cutis.inverse import Calibration, Model
from cutis.jobs.files import check_outputs
from cutis.jobs.job import digest_of
from cutis.kernels.behind import Behind
from cutis.looks import asked
from cutis.maps import (
    Change,
    Edits,
    Face,
    Header,
    MapsFile,
    Recipe,
    bound,
    find_source,
    maps_writer,
    open_source,
)
from cutis.maps.estimating import Progress, nobody
from cutis.maps.face import Memo
from cutis.maps.skin_maps import Recolouring
from cutis.maps.source import source_note
from cutis.optics import RARE_NAMES
from cutis.textures import TextureFile, format_of, sweep, texture_writer
from cutis.textures.udim import TOKEN, tile_of, udim_tiles


@dataclass(frozen=True)
class Edited:
    """What an edit did: its steps, texels clamped in each, texels of the mask, texels changed."""

    output: Path
    edits: tuple[str, ...]
    clamped: tuple[int, ...]
    inside: int
    changed: int
    notes: tuple[str, ...] = ()
    """What was chosen or not believed in the capture and the mask."""


@dataclass(frozen=True)
class EditJob:
    """A file of maps, what to do to it, and where the edited albedo goes.

    `edits` are a look, or edits in order: `amount` (0–1) of them, inside the painted `mask`.
    `source` is the capture where it is not where the maps say; `model` another model than that of
    the maps, `calibration` what the capture was multiplied by, where the maps lost it. `light`
    shows the face under another light. `space` is that of the output, None for the capture's.
    `save_maps` also writes the edited maps. Of a UDIM set, all names hold <UDIM>.
    """

    maps: Path
    output: Path = field(metadata={"result": False})
    edits: Edits = ()
    amount: float = 1.0
    mask: Path | None = None
    source: Path | None = None
    light: Light | None = None
    model: Model | None = None
    calibration: Calibration | None = None
    space: Space | None = None
    save_maps: Path | None = field(default=None, metadata={"result": False})

    def __post_init__(self) -> None:
        format_of(self.output)  # fails now rather than after the work
        asked(self.edits, self.amount)
        if TOKEN in self.maps.name:
            for path in (self.output, self.save_maps, self.source):
                if path is not None and TOKEN not in path.name:
                    raise CutisError(f"{path}: of a UDIM set, name it with {TOKEN} too")

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def tiles(self) -> "tuple[EditJob, ...]":
        """A job for each tile of a UDIM set; itself otherwise."""
        if TOKEN not in self.maps.name:
            return (self,)
        names = ("maps", "output", "mask", "source", "save_maps")
        paths: dict[str, Any] = {name: getattr(self, name) for name in names}
        tiles: list[EditJob] = []
        for number in udim_tiles(self.maps):
            named: dict[str, Any] = {n: p and tile_of(p, number) for n, p in paths.items()}
            tiles.append(replace(self, **named))
        return tuple(tiles)

    def run(self, progress: Progress = nobody) -> list[Edited]:
        """Writes the edited albedo of every tile, and the edited maps where that is asked for."""
        from cutis.jobs.job import part

        jobs, memo = self.tiles(), Memo()
        wanted = asked(self.edits, self.amount, self.mask)
        return [
            job._run(wanted, memo, part(progress, number, len(jobs)))
            for number, job in enumerate(jobs)
        ]

    def _run(self, wanted: Recipe, memo: Memo, progress: Progress) -> Edited:
        with contextlib.ExitStack() as stack:
            maps = stack.enter_context(MapsFile(self.maps))
            maps.named(self.model, self.calibration)
            path = find_source(maps.provenance, self.maps, self.source)
            inputs = {"the file of maps": self.maps, "the capture": path, "the mask": self.mask}
            check_outputs([self.output, self.save_maps], inputs)
            for output in (self.output, self.save_maps):
                if output is not None:
                    sweep(output.parent)
            texture = stack.enter_context(open_source(maps.provenance, path))
            if texture.shape != maps.shape:
                raise CutisError(f"{path}: the texture is {texture.shape}, the maps {maps.shape}")
            changes = bound([wanted], Face(maps, memo=memo, progress=progress))
            model = self.model or maps.made_by.load()
            done = self._albedo(stack, maps, texture, changes, model, progress)
            said = tuple(note for change in changes for note in change.notes)
            done = replace(done, notes=(*maps.notes, *texture.notes, *said))
            if self.save_maps is not None:
                looks = (*maps.header.looks, *wanted.documents)
                self._maps(stack, maps, texture, changes, looks, done, model, progress)
        return done

    def _albedo(
        self, stack: contextlib.ExitStack, maps: MapsFile, texture: TextureFile,
        changes: tuple[Change, ...], model: Model, progress: Progress,
    ) -> Edited:  # fmt: skip
        look = Recolouring(model, maps.header.calibration, self.light)
        writer = stack.enter_context(texture_writer(self.output, texture, self.space))
        height, width = maps.shape
        inside, changed = 0, 0
        clamped: Any = 0
        with Behind() as behind:
            for rows in texture.bands():
                skin = maps.edited(rows, changes, trust=False)
                part = texture.rows(rows)
                which, colours = look(skin, part.linear())
                result = part.with_linear(colours, which)
                behind.call(writer.write, result)
                inside += int(np.count_nonzero(skin.mask))
                changed += int(np.count_nonzero((result.pixels != part.pixels).any(axis=-1)))
                clamped = clamped + np.array(skin.clamped, dtype=np.int64)
                progress(min(rows.stop, height) * width, height * width, "editing")
        if not inside:
            raise maps.no_mask()
        told = tuple(int(count) for count in clamped[len(maps.header.edits) :])
        lines = tuple(line for change in changes for line in change.told)
        return Edited(self.output, lines, told, inside, changed)

    def _maps(
        self, stack: contextlib.ExitStack, maps: MapsFile, texture: TextureFile,
        changes: tuple[Change, ...], looks: tuple[str, ...], done: Edited, model: Model,
        progress: Progress,
    ) -> None:  # fmt: skip
        """In a second pass: the header says how many texels were clamped."""
        assert self.save_maps is not None
        before = maps.header
        touched = {name for change in changes for name in change.touches} | set(before.changed)
        header = Header(
            model.name, model.digest, before.calibration, source_note(texture), before.state,
            (*before.edits, *done.edits), (*before.clamped, *done.clamped), before.sigmas,
            before.confident, tuple(sorted(touched)),
            tuple(name for name in RARE_NAMES if name in touched | set(before.rare)),
            looks, before.tiles,
        )  # fmt: skip
        height, width = maps.shape
        put = stack.enter_context(maps_writer(self.save_maps, header, maps.shape))
        with Behind() as behind:
            for rows in maps.bands():
                behind.call(put, maps.edited(rows, changes))
                progress(min(rows.stop, height) * width, height * width, "writing maps")
