"""Textures looked at before anybody works with them: findings, and copies of what can be mended."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cutis.checks import Finding, examine, gather, thresholds
from cutis.checks.gathering import Gathered
from cutis.checks.mending import mend, mended_name
from cutis.checks.seams import check as check_seams
from cutis.checks.thresholds import Thresholds
from cutis.checks.tone import Tone
from cutis.colour import Space
from cutis.errors import CutisError
from cutis.inverse import Model
from cutis.jobs.files import check_outputs
from cutis.jobs.job import digest_of, part
from cutis.jobs.outcome import CaptureFiles
from cutis.jobs.runners import in_one_line
from cutis.maps import FileCapture, load_model
from cutis.maps.estimating import Progress, nobody
from cutis.textures import MaskFile, Orientation, TextureFile
from cutis.textures.mask import WrongSize
from cutis.textures.udim import tile_numbers


@dataclass(frozen=True)
class Checked:
    """What was found in one texture, or in one line why it could not be checked.

    `mended` are the files that were written of what could be put right.
    """

    face: Path
    findings: tuple[Finding, ...] = ()
    tone: Tone | None = None
    failure: str | None = None
    mended: tuple[Path, ...] = ()

    def count(self, level: str) -> int:
        """How many findings, or notes, there are."""
        return sum(one.level == level for one in self.findings)


@dataclass(frozen=True)
class CheckJob:
    """Textures of one set, the tiles of a UDIM texture or one, and what to judge them by.

    `limits` are thresholds (`checks.thresholds`), `colorspace` is that of the texels, None for what
    the file says. With `fix` what can be put right is written beside, as NAME.fixed.EXT.
    """

    captures: tuple[CaptureFiles, ...]
    model: Model = field(default_factory=load_model)
    limits: Thresholds = field(default_factory=thresholds)
    colorspace: Space | None = None
    orientation: Orientation = "auto"
    fix: bool = field(default=False, metadata={"result": False})

    def digest(self) -> str:
        """SHA-256 of all that the results depend on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> list[Checked]:
        """Looks at all of them; one that cannot be read leaves the others alone."""
        found: list[Checked] = []
        gathered: dict[Path, Gathered] = {}
        for number, capture in enumerate(self.captures):
            progress_of = part(progress, number, len(self.captures))
            progress_of(0, 1, f"looking at {capture.face.name}")
            try:
                found.append(self._one(capture, gathered))
            except Exception as error:
                found.append(Checked(capture.face, failure=str(in_one_line(error))))
            progress_of(1, 1, f"looking at {capture.face.name}")
        return self._with_seams(found, gathered)

    def _one(self, capture: CaptureFiles, gathered: dict[Path, Gathered]) -> Checked:
        more: list[Finding] = []
        with contextlib.ExitStack() as stack:
            texture = stack.enter_context(
                TextureFile(capture.face, self.colorspace or "auto", None, self.orientation)
            )
            mask = None
            if capture.mask is not None:
                try:
                    mask = stack.enter_context(
                        MaskFile(capture.mask, texture.frame, self.orientation)
                    )
                except WrongSize as error:
                    more.append(_wrong_size(error))
            seen = gathered[capture.face] = gather(FileCapture(texture, mask))
            if not seen.tallies.inside and mask is not None:
                raise mask.empty()
        judged = examine(seen, self.model, self.limits)
        findings = (*more, *judged.findings)
        mended = self._mend(capture, seen, findings) if self.fix else ()
        return Checked(capture.face, findings, judged.tone, mended=mended)

    def _mend(
        self, capture: CaptureFiles, seen: Gathered, findings: Sequence[Finding]
    ) -> tuple[Path, ...]:
        inputs = {"the texture": capture.face, "the mask": capture.mask}
        outputs = [mended_name(path) for path in (capture.face, capture.mask) if path is not None]
        check_outputs(outputs, inputs)
        return mend(capture.face, capture.mask, findings, self.colorspace, self.orientation)

    def _with_seams(self, found: list[Checked], gathered: Mapping[Path, Gathered]) -> list[Checked]:
        """The same, with the seams between tiles."""
        numbers = tile_numbers([one.face for one in self.captures])
        if not numbers:
            return found
        faces = sorted(one.face for one in self.captures)
        tiles = {
            number: gathered[face]
            for number, face in zip(numbers, faces, strict=True) if face in gathered
        }  # fmt: skip
        seams = list(check_seams(tiles, self.limits["seams"]))
        names = dict(zip(numbers, faces, strict=True))
        return [
            Checked(
                one.face,
                (*one.findings, *(seam for number, seam in seams if names[number] == one.face)),
                one.tone, one.failure, one.mended,
            ) for one in found
        ]  # fmt: skip


def _wrong_size(error: WrongSize) -> Finding:
    return Finding(
        "mask-size", "finding", f"{error}; it was checked without.", "Paint or scale the mask anew."
    )


def code_of(found: Sequence[Checked], strict: bool) -> int:
    """The exit code: 0 clean or notes only, 1 findings (`strict`: or notes), 2 not all checked."""
    if any(one.failure is not None for one in found):
        return 2
    bad = any(one.count("finding") or (strict and one.findings) for one in found)
    return int(bad)


def check_all(jobs: Sequence[CheckJob], progress: Progress = nobody) -> Iterator[Checked]:
    """All sets, one after the other; CutisError where there is nothing to check."""
    if not jobs:
        raise CutisError("there is nothing to check")
    for number, job in enumerate(jobs):
        yield from job.run(part(progress, number, len(jobs)))
