"""`cutis estimate`: captures in, maps, model albedo, previews and report out."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options
from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.outcome import Estimated

Faces = Annotated[
    list[str],
    typer.Argument(
        metavar="FACE...",
        help="Albedo textures: PNG, JPEG, TIFF, TX, EXR, DPX, PSD; NAME.<UDIM>.EXT; a folder, "
        "alone or with a pattern such as '*.exr'.",
    ),
]


def estimate(
    faces: Faces,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.")] = Path(
        "."
    ),
    mask: options.Mask = None,
    white: options.White = "none",
    exposure: options.Exposure = "none",
    illuminant: options.Illuminant = "D65",
    model: options.ModelName = "default",
    method: options.Method = None,
    colorspace: options.Colorspace = "auto",
    ocio: options.Ocio = None,
    output_colorspace: options.OutputColorspace = None,
    device: Annotated[
        str, typer.Option(help="Where networks run: cpu, or cuda with PyTorch for it.")
    ] = "cpu",
    half: Annotated[bool, typer.Option(help="Store the maps as half instead of float.")] = False,
    no_sigma: Annotated[
        bool, typer.Option("--no-sigma", help="Leave standard deviations and confidence out.")
    ] = False,
    report: Annotated[bool, typer.Option("--report", help="Also write NAME.report.html.")] = False,
    regions: Annotated[
        Path | None,
        typer.Option(help="Picture in flat colours, one for each region to report on."),
    ] = None,
    orientation: options.Turning = options.Turn.AUTO,
    steady: options.Steadiness = options.Switch.OFF,
    udim: Annotated[bool, typer.Option("--udim", help="FACE is one tile of a UDIM set.")] = False,
    sequence: Annotated[
        bool, typer.Option("--sequence", help="All are of one person: share one calibration.")
    ] = False,
    jobs: Annotated[
        int, typer.Option("--jobs", "-j", min=1, max=256, help="Processes to work in.")
    ] = 1,
    cluster: options.Cluster = None,
    again: options.Again = False,
    quiet: options.Quiet = False,
) -> None:
    """Estimate skin maps of albedo textures.

    Writes NAME.skin.exr (the maps), NAME.model.exr (what the model alone gives), NAME.report.json
    and previews NAME.<map>.png for each.

    Example: cutis estimate face.png --mask mask.png --white auto -o out/

    Example: cutis estimate show/ '*.exr' --jobs 4 -o out/
    """
    from dataclasses import replace

    from cutis.apps import estimate_words as words
    from cutis.apps.console import bar
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.inputs import capture_sets, companion
    from cutis.jobs.outcome import CaptureFiles
    from cutis.jobs.runners import cluster as on_cluster
    from cutis.jobs.runners import here, processes
    from cutis.jobs.sets import estimate_sets

    like = EstimateJob(
        (CaptureFiles(Path()),), output, options.white_gains(white),
        options.exposure_gain(exposure), options.light_of(illuminant),
        options.model_of(model, method, device), options.source_space(colorspace, ocio),
        options.space_of(output_colorspace, ocio), half, not no_sigma, report,
        orientation.value, steady.value == "on", again,
    )  # fmt: skip
    sets = []
    doubts: list[str] = []
    for captures in capture_sets(faces, udim, sequence, doubts.append):
        files = (CaptureFiles(f, companion(mask, f), companion(regions, f)) for f in captures)
        sets.append(replace(like, captures=tuple(files)))
    runner = here if cluster is None and jobs == 1 else processes(jobs)
    if cluster is not None:
        runner = on_cluster(cluster)
    with bar(quiet) as progress:
        found = list(estimate_sets(sets, runner, progress))
    if not quiet:
        words.say(sets, found, doubts)
    _fail(sets, found)


def _fail(sets: "Sequence[EstimateJob]", found: "Sequence[Estimated]") -> None:
    """CutisError that lists what failed, and what nobody has heard of."""
    lines = []
    for outcome in found:
        if outcome.failure is not None:
            named = outcome.face.name in outcome.failure
            lines.append(outcome.failure if named else f"{outcome.face}: {outcome.failure}")
    total = sum(len(job.captures) for job in sets)
    if total > len(found):
        lines.append(f"{total - len(found)} captures were not done; run the same command again")
    if not lines:
        return
    if total == 1:
        raise CutisError(lines[0])
    raise CutisError(f"{len(lines)} of {total} failed: {'; '.join(lines)}")
