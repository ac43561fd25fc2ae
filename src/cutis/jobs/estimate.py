"""Captures from files to files: maps, model albedo, previews and report of each.

The captures of a job are one set: they share what a survey of all of them finds, light and gains
first. Each goes through in bands of rows, so that memory does not grow with the image.
"""

import contextlib
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from cutis.arrays import Map
from cutis.checks import examine, watch
from cutis.checks.gathering import Gathered
from cutis.colour import LINEAR, Light, Space, light
from cutis.errors import CutisError
from cutis.inverse import Model
from cutis.inverse.calibration import Exposure, White
from cutis.inverse.model import content_digest
from cutis.jobs.files import made_folder
from cutis.jobs.job import Told, digest_of, tell, told
from cutis.jobs.outcome import Asked, CaptureFiles, Estimated
from cutis.jobs.results import FILES, MADE_FROM, Found, alone, look, made_from
from cutis.kernels.behind import Behind
from cutis.maps import FileCapture, Header, Surveyed, estimate_bands, load_model, survey
from cutis.maps.estimating import Progress, nobody
from cutis.maps.skin_maps import Estimate
from cutis.maps.source import source_note
from cutis.maps.writing import maps_writer
from cutis.optics import NAMES
from cutis.report import Regions, RunningReport
from cutis.report.numbers import Doubt
from cutis.report.page import write_report
from cutis.report.previews import Previews
from cutis.textures import (
    MaskFile,
    Orientation,
    TextureFile,
    channel_writer,
    replacing,
    sweep,
)
from cutis.textures.udim import tile_numbers


@dataclass(frozen=True)
class EstimateJob:
    """Captures of one set, how to estimate them, and the folder where results go.

    `captures` share light and gains: the tiles of a UDIM texture, frames of one person, or one
    capture. `white` and `exposure` are "none", "auto" or gains (`inverse.calibrate`), `light` is
    that of the capture, `colorspace` that of its texels, None for what the file says;
    `output_colorspace` is that of NAME.model.exr, None for linear sRGB. `half` stores maps in half
    the size, `sigma` adds standard deviations and confidence where the model knows them, `page`
    adds NAME.report.html. `orientation` "ignore" keeps pictures in the order they are stored in,
    whatever their tag says. `steady` lets models look at neighbours. `again` makes anew
    what is there, also what was made otherwise.
    """

    captures: tuple[CaptureFiles, ...]
    output: Path = field(default=Path(), metadata={"result": False})
    white: White = "none"
    exposure: Exposure = "none"
    light: Light = field(default_factory=lambda: light("D65"))
    model: Model = field(default_factory=load_model)
    colorspace: Space | None = None
    output_colorspace: Space | None = None
    half: bool = False
    sigma: bool = True
    page: bool = False
    orientation: Orientation = "auto"
    steady: bool = False
    again: bool = field(default=False, metadata={"result": False})

    def __post_init__(self) -> None:
        if not self.captures:
            raise CutisError("there is no capture to estimate")

    def digest(self) -> str:
        """SHA-256 of all that the results depend on."""
        return digest_of(self)

    def run(self, progress: Progress = nobody) -> list[Estimated]:
        """Estimates what is not there yet; a capture that fails leaves the others alone."""
        from cutis.jobs.runners import here
        from cutis.jobs.sets import estimate_sets

        return list(estimate_sets([self], here, progress))

    def absolute(self) -> "EstimateJob":
        """The same under whole names, for work in other processes."""
        files = tuple(
            CaptureFiles(*(None if path is None else Path(os.path.abspath(path)) for path in paths))  # type: ignore[arg-type]
            for paths in ((one.face, one.mask, one.regions) for one in self.captures)
        )
        return replace(self, captures=files, output=Path(os.path.abspath(self.output)))

    # the steps, which runners put together ----------------------------------------------------

    @property
    def used(self) -> Model:
        """The model as it is used: with neighbours or without."""
        return self.model if self.steady else self.model.alone

    def stem(self, capture: CaptureFiles) -> Path:
        """Results are called this and what they are: STEM.skin.exr."""
        return self.output / capture.face.stem

    def report_file(self, capture: CaptureFiles) -> Path:
        """The report of a capture."""
        return Path(f"{self.stem(capture)}.report.json")

    def shared(self) -> Asked:
        """What the results of all captures depend on; files that are not there count as empty."""
        shared = {name: one for name, one in told(self).items() if name != "captures"}
        if "auto" in (self.white, self.exposure) or self.model.survey is not None:
            files = [path for one in self.captures for path in (one.face, one.mask) if path]
            whole = sorted(tell(path).content for path in files)
            shared["set"] = Told("", content_digest(whole))
        return shared

    def own(self, capture: CaptureFiles) -> Asked:
        """What the result of one capture depends on beside; CutisError where a file is missing."""
        return {
            "capture": _file(capture.face),
            "mask": _file(capture.mask),
            "regions": _file(capture.regions),
        }

    def found(self, capture: CaptureFiles, asked: Asked) -> Found:
        """What is there of a capture's result."""
        return look(self.report_file(capture), asked)

    def survey(self, progress: Progress = nobody) -> Surveyed:
        """What the captures share; those that cannot be read have no part in it."""
        captures = self.captures
        try:
            return self._surveyed(captures, progress)
        except (CutisError, OSError):
            good = tuple(one for one in captures if self._readable(one))
            if not good or good == captures:
                raise
            return self._surveyed(good, progress)

    def _surveyed(self, captures: tuple[CaptureFiles, ...], progress: Progress) -> Surveyed:
        opened = [lambda one=one: self._opened(one) for one in captures]
        return survey(opened, self.used, self.white, self.exposure, self.light, progress)

    def _readable(self, capture: CaptureFiles) -> bool:
        try:
            with self._opened(capture) as opened:
                for rows in opened.bands():
                    opened.rows(rows)
        except (CutisError, OSError):
            return False
        return True

    def estimate(
        self, capture: CaptureFiles, known: Surveyed, asked: Asked, progress: Progress = nobody
    ) -> Estimated:
        """Writes the results of one capture: STEM.skin.exr, STEM.model.exr, previews, report."""
        with made_folder(self.output), alone(self.stem(capture)):
            self.report_file(capture).unlink(missing_ok=True)
            sweep(self.output)
            return self._write(capture, known, asked, progress)

    @contextlib.contextmanager
    def _opened(self, capture: CaptureFiles) -> Iterator[FileCapture]:
        """A capture and its mask, open."""
        with contextlib.ExitStack() as stack:
            texture = stack.enter_context(
                TextureFile(capture.face, self.colorspace or "auto", None, self.orientation)
            )
            mask = None
            if capture.mask is not None:
                mask = MaskFile(capture.mask, texture.frame, self.orientation)
            yield FileCapture(texture, None if mask is None else stack.enter_context(mask))

    def outputs(self, capture: CaptureFiles) -> list[Path]:
        """All files that may come of a capture."""
        stem = self.stem(capture)
        return [Path(f"{stem}{end}") for end in ENDS]

    def _write(
        self, capture: CaptureFiles, known: Surveyed, asked: Asked, progress: Progress
    ) -> Estimated:
        stem = self.stem(capture)
        with contextlib.ExitStack() as stack:
            opened = stack.enter_context(self._opened(capture))
            looked_at = watch(opened)
            run = _Run(self, known, opened, stem, stack)
            regions = None
            if capture.regions is not None:
                frame = opened.texture.frame
                regions = stack.enter_context(Regions(capture.regions, frame, self.orientation))
            run.through(regions, progress)
            if not opened.seen:
                raise opened.empty()
        texture = opened.texture
        notes = [*texture.notes, *([] if opened.mask is None else opened.mask.notes)]
        numbers = () if regions is None else regions.finish()
        report = replace(
            run.report.finish(),
            colorspace=f"{texture.space.name} ({texture.origin})",
            regions=numbers,
            notes=(*notes, *([] if regions is None else regions.notes)),
            doubts=self._doubts(looked_at.finish()),
        )
        total = opened.shape[0] * opened.shape[1]
        progress(total, total, "drawing previews")
        files = [f"{stem.name}.skin.exr", f"{stem.name}.model.exr"]
        files += [path.name for path in run.previews.write(stem)]
        pictures = run.previews.pictures()
        if self.page:
            write_report(Path(f"{stem}.report.html"), report, pictures, capture.face.name)
            files.append(f"{stem.name}.report.html")
        results = {**report.as_dict(), FILES: files, MADE_FROM: made_from(asked)}
        with replacing(self.report_file(capture)) as path:
            path.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
        return Estimated(capture.face, report, pictures=pictures)

    def _doubts(self, gathered: Gathered) -> tuple[Doubt, ...]:
        """Why the capture may be no albedo of skin; what was asked to be searched for is none."""
        searched = {"cast", "exposure"} if self.white == "auto" else set[str]()
        searched |= {"exposure"} if self.exposure == "auto" else set()
        return tuple(
            Doubt(one.kind, one.sentence, one.hint)
            for one in examine(gathered).findings
            if one.level == "finding" and one.kind not in searched
        ) if gathered.tallies.inside else ()  # fmt: skip


ENDS = (
    ".skin.exr", ".model.exr", ".report.json", ".report.html",
    *(f".{name}.png" for name in (*NAMES, "error", "sigma", "confidence")),
)  # fmt: skip
"""How names of results may end."""


class _Run:
    """One capture on its way through, with all that is made of it."""

    def __init__(
        self, job: EstimateJob, known: Surveyed, opened: FileCapture, stem: Path,
        stack: contextlib.ExitStack,
    ) -> None:  # fmt: skip
        self._job, self._known, self._opened = job, known, opened
        self._sigma = job.sigma and (
            job.model.to_trust is not None or job.model.of_tile is not None
        )
        kind: Literal["half", "float"] = "half" if job.half else "float"
        space = self._space = job.output_colorspace or LINEAR
        header: dict[str, Any] = {"colorspace": "lin_rec709" if space == LINEAR else space.name}
        if space.chromaticities is not None and not space.encoded:
            header["chromaticities"] = space.chromaticities
        self.report = RunningReport(job.model, known.calibration, opened.shape)
        self.previews = Previews(known.calibration, opened.shape)
        self._notes = source_note(opened.texture)
        self._put_maps: Any = None
        self._put_model = stack.enter_context(
            channel_writer(
                f"{stem}.model.exr", "RGB", opened.shape, kind, header, frame=opened.texture.frame
            )
        )
        self._open_maps: Callable[[Estimate], Any] = lambda first: stack.enter_context(
            maps_writer(
                f"{stem}.skin.exr", self._header(first), opened.shape, kind, self.report.statistics
            )
        )

    def _header(self, first: Estimate) -> Header:
        model, known = self._job.model, self._known
        return Header(
            model.name, model.digest, known.calibration, self._notes, known.state,
            sigmas=tuple(first.sigmas), confident=first.confidence is not None,
            tiles=tile_numbers([one.face for one in self._job.captures]),
        )  # fmt: skip

    def through(self, regions: Regions | None, progress: Progress) -> None:
        """Estimates all rows; what is ready is written meanwhile."""
        height, width = self._opened.shape
        bands = estimate_bands(self._opened, self._job.used, self._known, sigma=self._sigma)
        with Behind() as behind:
            for rows, skin in bands:
                if self._put_maps is None:
                    self._put_maps = self._open_maps(skin)
                behind.call(self._put, skin, self._space.from_linear_srgb(skin.model_albedo))
                self.report.add(skin)
                self.previews.add(skin)
                if regions is not None:
                    regions.add(skin, rows)
                progress(min(rows.stop, height) * width, height * width, "estimating")

    def _put(self, skin: Estimate, albedo: Map) -> None:
        self._put_maps(skin)
        self._put_model({name: albedo[..., i] for i, name in enumerate("RGB")})


def _file(path: Path | None) -> Told:
    """A file by name and content; CutisError where it is not there."""
    if path is None:
        return Told("none")
    try:
        return tell(_present(path))
    except OSError as error:
        raise CutisError(f"{path}: {error.strerror or error}; check the name") from error


def _present(path: Path) -> Path:
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "no such file"
        raise CutisError(f"{path}: {what}; check the name")
    return path
