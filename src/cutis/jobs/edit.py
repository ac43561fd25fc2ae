"""One file of maps edited: from maps and capture to the edited albedo, in bands of rows."""

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.colour import Space
    from cutis.jobs.estimate import Progress
    from cutis.maps import Edit


@dataclass(frozen=True)
class Job:
    """What to edit, how, and where to."""

    maps: Path
    output: Path
    edits: "tuple[Edit, ...]"
    amount: float = 1.0
    mask: Path | None = None
    source: Path | None = None
    model: str | None = None
    space: "Space | None" = None
    save_maps: Path | None = None
    illuminant: str | None = None

    def tile(self, number: int, tile_of: Callable[[Path, int], Path]) -> "Job":
        """The same for one tile of a UDIM set."""
        names = ("maps", "output", "mask", "source", "save_maps")
        paths = {name: getattr(self, name) for name in names}
        tiles: dict[str, Any] = {n: p and tile_of(p, number) for n, p in paths.items()}
        return replace(self, **tiles)


@dataclass(frozen=True)
class Edited:
    """What an edit did: its steps, texels clamped in each, texels of the mask, texels changed."""

    edits: tuple[str, ...]
    clamped: tuple[int, ...]
    inside: int
    changed: int


def edit_file(job: Job, progress: "Progress") -> Edited:
    """Writes the edited albedo, and the edited maps where that is asked for."""
    import numpy as np

    from cutis.maps import MapsFile, blank, find_source, maps_writer, open_source, source_note
    from cutis.optics import RARE_NAMES
    from cutis.textures import MaskFile, texture_writer

    with contextlib.ExitStack() as stack:
        maps = stack.enter_context(MapsFile(job.maps))
        model = maps.model if job.model is None else job.model
        path = find_source(maps.provenance, job.maps, job.source)
        for written in (job.output, job.save_maps):
            if written is not None and same_file(written, path):
                raise CutisError(f"{written} is the capture itself; give another name")
        for other in (job.maps, job.save_maps):
            if other is not None and same_file(job.output, other):
                raise CutisError(f"{job.output} is a file of maps; give another name")
        texture = stack.enter_context(open_source(maps.provenance, path))
        shape, total = maps.shape, maps.shape[0] * maps.shape[1]
        if texture.shape != shape:
            raise CutisError(f"{path}: the texture is {texture.shape}, the maps are {shape}")
        mask = None if job.mask is None else stack.enter_context(MaskFile(job.mask, shape))
        # the header of edited maps says how many texels were clamped, so they come in a second pass
        inside, changed, marked, clamped = 0, 0, False, None
        writer = stack.enter_context(texture_writer(job.output, texture, job.space))
        for rows in texture.bands():
            skin = replace(maps.rows(rows, trust=False), model=model)
            where = None if mask is None else mask.rows(rows)
            edited = skin.apply(job.edits, where, amount=job.amount)
            part = texture.rows(rows)
            result = edited.retouch(part, job.illuminant)
            writer.write(result)
            inside += int(np.count_nonzero(skin.mask))
            marked = marked or where is None or bool((where > MaskFile.BLACK).any())
            changed += int(np.count_nonzero((result.pixels != part.pixels).any(axis=-1)))
            counts = np.array(edited.clamped, dtype=np.int64)
            clamped = counts if clamped is None else clamped + counts
            progress(min(rows.stop, shape[0]) * shape[1], total, "editing")
        if not inside:
            raise maps.no_mask()
        if not marked and mask is not None:
            raise mask.empty()
        assert clamped is not None
        told = tuple(int(count) for count in clamped[len(maps.edits) :])
        names = edited.edits
        if job.save_maps is not None:
            touched = {edit.parameter for edit in job.edits} | set(maps.changed)
            rare = [name for name in RARE_NAMES if name in touched | set(maps.rare)]
            like = blank(maps.calibration, model, source_note(texture), maps.sigmas, maps.confident)
            like = replace(like, edits=names, clamped=(*maps.clamped, *told))
            put = stack.enter_context(
                maps_writer(job.save_maps, like, shape, "float", sorted(touched), rare)
            )
            for rows in maps.bands():
                where = None if mask is None else mask.rows(rows)
                skin = replace(maps.rows(rows), model=model)
                put(skin.apply(job.edits, where, amount=job.amount))
                progress(min(rows.stop, shape[0]) * shape[1], total, "writing maps")
    return Edited(names[len(maps.edits) :], told, inside, changed)


def same_file(one: Path, other: Path) -> bool:
    """Whether two names are of one file, also through links."""
    return one.resolve() == other.resolve() or (
        one.exists() and other.exists() and one.samefile(other)
    )
