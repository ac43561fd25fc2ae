"""One capture from file to files: what `cutis estimate` does to each of its inputs.

Everything goes through in bands of rows, so that memory does not grow with the image.
"""

import contextlib
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from cutis.apps import options

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from cutis.inverse import Calibration
    from cutis.report import Report
    from cutis.textures import MaskFile, TextureFile

Progress = Callable[[int, int, str], None]
"""Takes texels done, texels in all, and what is being done."""


@dataclass(frozen=True)
class Settings:
    """What the results depend on, besides the files themselves; as the flags give it."""

    white: str = "none"
    exposure: str = "none"
    illuminant: str = "D65"
    model: str = "default"
    colorspace: str = "auto"
    ocio: str | None = None
    """A configuration; "" for none, None for $OCIO."""
    output_colorspace: str | None = None
    half: bool = False
    page: bool = False
    device: str = "cpu"
    sigma: bool = True


@dataclass(frozen=True)
class Task:
    """A capture, the mask and the regions that belong to it, and where results go."""

    face: Path
    mask: Path | None
    output: Path
    settings: Settings
    regions: Path | None = None

    @property
    def stem(self) -> Path:
        """Results are called this and what they are: STEM.skin.exr."""
        return self.output / self.face.stem

    @contextlib.contextmanager
    def opened(self) -> Iterator[tuple["TextureFile", "MaskFile | None"]]:
        """The capture and its mask, open."""
        from cutis.textures import MaskFile, TextureFile

        with contextlib.ExitStack() as stack:
            how = self.settings
            texture = stack.enter_context(TextureFile(self.face, how.colorspace, how.ocio))
            mask = None if self.mask is None else MaskFile(self.mask, texture.shape)
            yield texture, mask if mask is None else stack.enter_context(mask)


def cover_of(part: Any, mask: "MaskFile | None", rows: slice) -> "NDArray[np.float32]":
    """Where skin is in some rows of a texture, (h, W) in [0, 1]: the mask, else alpha."""
    import numpy as np

    if mask is not None:
        return mask.rows(rows)
    alpha = part.alpha()
    return np.ones(part.shape, np.float32) if alpha is None else (alpha > 0).astype(np.float32)


def calibrated(tasks: Sequence[Task], progress: Progress) -> "Calibration":
    """The calibration that captures of one set share."""
    from cutis.inverse import calibrate, tissue_of
    from cutis.maps import Sampler

    how = tasks[0].settings
    white, exposure = options.white_gains(how.white), options.exposure_gain(how.exposure)
    if "auto" not in (white, exposure):
        return calibrate(_no_colours(), white, exposure, how.illuminant)
    with contextlib.ExitStack() as stack:
        opened = [stack.enter_context(task.opened()) for task in tasks]
        total = sum(texture.shape[0] * texture.shape[1] for texture, _ in opened)
    sampler = Sampler(total)
    while not sampler.enough():
        done = 0
        for task in tasks:
            with task.opened() as (texture, mask):
                for rows in texture.bands():
                    part = texture.rows(rows)
                    sampler.add(rows.start, part.linear(), cover_of(part, mask, rows))
                    done += part.shape[0] * part.shape[1]
                    progress(done, total, "looking for gains")
    progress(total, total, "calibrating")
    return calibrate(sampler.colours(), white, exposure, how.illuminant, tissue_of(how.model))


def _no_colours() -> "NDArray[np.float32]":
    import numpy as np

    return np.zeros((0, 3), np.float32)


def estimate_file(
    task: Task, calibration: "Calibration", progress: Progress, made_from: str | None = None
) -> "Report":
    """Writes STEM.skin.exr, STEM.model.exr, previews, STEM.report.json; returns the report.

    `made_from` goes into the report, which is written last: it says that all the rest is there.
    """
    return estimate_and_show(task, calibration, progress, made_from)[0]


def estimate_and_show(
    task: Task, calibration: "Calibration", progress: Progress, made_from: str | None = None
) -> "tuple[Report, dict[str, NDArray[np.float32]]]":
    """The same; returns the report and the reduced pictures of the previews."""
    import cutis.maps as maps
    from cutis.colour import LINEAR
    from cutis.inverse import load_model, on_device
    from cutis.optics import NAMES
    from cutis.report import Regions, RunningReport
    from cutis.report.previews import Previews
    from cutis.textures import channel_writer, colour_space, replacing, sweep

    how, stem = task.settings, task.stem
    kind: Literal["half", "float"] = "half" if how.half else "float"
    name = how.output_colorspace
    space = LINEAR if name is None else colour_space(name, how.ocio)
    seen = False
    with contextlib.ExitStack() as stack:
        stack.enter_context(on_device(how.device))
        texture, mask = stack.enter_context(task.opened())
        stack.enter_context(options.made_folder(task.output))
        sweep(task.output)
        shape, total = texture.shape, texture.shape[0] * texture.shape[1]
        trusted = how.sigma and load_model(how.model).to_trust is not None
        like = maps.blank(
            calibration, how.model, maps.source_note(texture), NAMES if trusted else (), trusted
        )
        running, previews = RunningReport(like, shape), Previews(calibration, shape)
        regions = None if task.regions is None else Regions(task.regions, shape)
        header: dict[str, Any] = {"colorspace": "lin_rec709" if space == LINEAR else space.name}
        if space.chromaticities is not None and not space.encoded:
            header["chromaticities"] = space.chromaticities
        put_maps = stack.enter_context(maps.maps_writer(f"{stem}.skin.exr", like, shape, kind))
        put_model = stack.enter_context(
            channel_writer(f"{stem}.model.exr", "RGB", shape, kind, header)
        )
        for rows in texture.bands():
            part = texture.rows(rows)
            cover, source = cover_of(part, mask, rows), part.linear()
            seen = seen or bool((cover > (0 if mask is None else mask.BLACK)).any())
            found: dict[str, Any] = maps.estimate_rows(
                source, cover, calibration, how.model, trusted
            )
            skin = replace(
                like, **found, mask=cover, source=source, first_row=rows.start, whole=shape
            )
            put_maps(skin)
            albedo = space.from_linear_srgb(skin.model_albedo)
            put_model({name: albedo[..., i] for i, name in enumerate("RGB")})
            running.add(skin)
            previews.add(skin)
            if regions is not None:
                regions.add(skin, rows)
            progress(min(rows.stop, shape[0]) * shape[1], total, "estimating")
        if not seen:
            raise _empty(task) if mask is None else mask.empty()
    results = replace(
        running.finish(),
        colorspace=f"{texture.space.name} ({texture.origin})",
        regions=() if regions is None else regions.finish(),
        made_from=made_from,
    )
    progress(total, total, "drawing previews")
    previews.write(stem)
    if how.page:
        from cutis.report.page import write_report

        write_report(Path(f"{stem}.report.html"), results, previews.pictures(), task.face.name)
    with replacing(Path(f"{stem}.report.json")) as path:
        path.write_text(json.dumps(results.as_dict(), indent=2) + "\n", encoding="utf-8")
    return results, previews.pictures()


def _empty(task: Task) -> Exception:
    from cutis.errors import CutisError

    return CutisError(f"{task.face}: all of it is transparent, so that nothing is skin")
