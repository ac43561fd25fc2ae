"""An edit that grows from picture to picture: numbered files, and a film of them to look at."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.jobs.edit import EditJob
from cutis.jobs.job import digest_of, part
from cutis.maps import MapsFile, find_source, open_source
from cutis.maps.estimating import Progress, nobody
from cutis.render.display import write_animation
from cutis.render.frames import Frame, file_names
from cutis.textures.udim import TOKEN

AMOUNTS = re.compile(r"^\s*([0-9.eE+-]+?)\s*\.\.\s*([0-9.eE+-]+)\s*$")
MOST = 10_000
"""Pictures of a sequence."""
LONGEST = 1024
"""Pixels of the longer side of the film."""


@dataclass(frozen=True)
class Sequence:
    """What was written: the pictures in order, and the film; of a UDIM set there is none."""

    pictures: tuple[Path, ...]
    film: Path | None = None


@dataclass(frozen=True)
class EditFramesJob:
    """An edit with one amount (0-1) after the other, which take the place of its own.

    Pictures are NAME.0001.EXT, NAME.0002.EXT, … of the edit's output NAME.EXT, and each is what the
    edit with that amount is; the film is NAME.webp.
    """

    edit: EditJob
    amounts: tuple[float, ...]

    def __post_init__(self) -> None:
        if not 2 <= len(self.amounts) <= MOST:
            raise CutisError(f"a sequence has 2 to {MOST} pictures, not {len(self.amounts)}")
        if self.edit.save_maps is not None:
            raise CutisError("a sequence is of pictures; save the maps of one amount by itself")
        self._jobs()  # amounts that are none

    def digest(self) -> str:
        """SHA-256 of all that the result depends on."""
        return digest_of(self)

    def _jobs(self) -> list[EditJob]:
        frames = [Frame(number) for number in range(1, len(self.amounts) + 1)]
        output = self.edit.output
        names = file_names(frames, str(output.with_suffix("")), output.suffix)
        return [
            replace(self.edit, output=Path(name), amount=amount)
            for (_, name), amount in zip(names, self.amounts, strict=True)
        ]

    def run(self, progress: Progress = nobody) -> Sequence:
        """Writes the pictures, then the film."""
        jobs = self._jobs()
        written: list[Path] = []
        for number, job in enumerate(jobs):
            written += [one.output for one in job.run(part(progress, number, len(jobs) + 1))]
        if TOKEN in self.edit.maps.name:
            return Sequence(tuple(written))
        progress(len(jobs), len(jobs) + 1, "moving preview")
        film = self.edit.output.with_suffix(".webp")
        write_animation(written, film, self._space(), LONGEST)
        return Sequence(tuple(written), film)

    def _space(self) -> Space:
        """Of the colours of the pictures."""
        edit = self.edit
        if edit.space is not None:
            return edit.space
        with MapsFile(edit.maps) as maps:
            path = find_source(maps.provenance, edit.maps, edit.source)
            with open_source(maps.provenance, path) as texture:
                return texture.space


def amounts_of(text: str, count: int | None) -> tuple[float, ...]:
    """The amounts of "0..1" in so many even steps, 24 without a number; of "0.5", that one.

    Raises CutisError for anything else.
    """
    found = AMOUNTS.match(text)
    try:
        ends = [float(one) for one in (found.groups() if found else (text,))]
        if not all(0 <= one <= 1 for one in ends):
            raise ValueError
    except ValueError:
        raise CutisError(
            f"--amount is a number from 0 to 1, or a range such as 0..1, not {text.strip()!r}"
        ) from None
    if found is None and count is not None:
        raise CutisError("--frames is of a range of amounts: give --amount 0..1 too")
    if found is None:
        return (ends[0],)
    if not 2 <= (count or 24) <= MOST:
        raise CutisError(f"a sequence has 2 to {MOST} pictures, not {count}")
    return tuple(float(one) for one in np.linspace(ends[0], ends[1], count or 24))
