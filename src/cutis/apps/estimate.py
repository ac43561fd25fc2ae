"""`cutis estimate`: captures in, maps, model albedo, previews and report out."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.jobs.sets import Outcome, Runner
    from cutis.report import Report


def estimate(
    faces: Annotated[
        list[str],
        typer.Argument(
            metavar="FACE...",
            help="Albedo textures: PNG, JPEG, TIFF, TX, EXR, DPX, PSD; NAME.<UDIM>.EXT; a folder, "
            "alone or with a pattern such as '*.exr'.",
        ),
    ],
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
    udim: Annotated[bool, typer.Option("--udim", help="FACE is one tile of a UDIM set.")] = False,
    sequence: Annotated[
        bool, typer.Option("--sequence", help="All are of one person: share one calibration.")
    ] = False,
    jobs: Annotated[
        int, typer.Option("--jobs", "-j", min=1, max=256, help="Processes to work in.")
    ] = 1,
    cluster: Annotated[
        str | None, typer.Option(help="Dask scheduler to work on: tcp://host:8786.")
    ] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Also what is there already, made the same way.")
    ] = False,
    quiet: options.Quiet = False,
) -> None:
    """Estimate skin maps of albedo textures.

    Writes NAME.skin.exr (the maps), NAME.model.exr (what the model alone gives), NAME.report.json
    and previews NAME.<map>.png for each.

    Example: cutis estimate face.png --mask mask.png --white auto -o out/

    Example: cutis estimate show/ '*.exr' --jobs 4 -o out/
    """
    from cutis.apps.console import out, steps
    from cutis.colour import light_conversion
    from cutis.errors import CutisError
    from cutis.inverse import load_model, model_name
    from cutis.jobs.estimate import Settings, Task
    from cutis.jobs.inputs import capture_sets, companion, gaps, odd_ones
    from cutis.jobs.sets import cluster as on_cluster
    from cutis.jobs.sets import estimate_sets, here, processes
    from cutis.textures import colour_space
    from cutis.textures.ocio import configured

    if method is not None:
        if model != "default":
            raise CutisError("give either --model or --method, not both")
        model = options.method_name(method)
    model = model_name(model)  # results of another default are not these
    ocio = ocio or configured() or ""  # said to workers, who may have another $OCIO
    settings = Settings(
        white, exposure, illuminant, model, colorspace, ocio, output_colorspace, half, report,
        device, not no_sigma,
    )  # fmt: skip
    # what is wrong with the flags is said now rather than after reading
    light_conversion(illuminant)
    options.white_gains(white), options.exposure_gain(exposure)
    load_model(model, device)
    for name in (None if colorspace == "auto" else colorspace, output_colorspace):
        if name is not None:
            colour_space(name, ocio)
    sets = [
        [
            Task(face, companion(mask, face), output, settings, companion(regions, face))
            for face in captures
        ]
        for captures in capture_sets(faces, udim, sequence)
    ]
    runner: Runner = here
    if cluster is not None:
        runner = on_cluster(cluster)
    elif jobs > 1:
        runner = processes(jobs)
    alone = len(sets) == 1 and len(sets[0]) == 1
    with steps(1, quiet) as progress:
        found = list(estimate_sets(sets, runner, again or alone, progress.at))
    failed = [outcome for outcome in found if outcome.failure is not None]
    if alone and failed:
        raise CutisError(str(failed[0].failure))
    if not quiet:
        for tasks in sets:
            captures = tuple(task.face for task in tasks)
            for name in gaps(captures):
                out.print(f"{name} is missing between other tiles of its row")
            for line in odd_ones(captures, colorspace, ocio):
                out.print(line)
        if alone:
            assert found[0].report is not None
            out.print(f"wrote {sets[0][0].stem}.skin.exr and what belongs to it")
            say(found[0].report, sets[0][0].face, sets[0][0].stem)
        else:
            say_all(found, output)
    if failed:
        listed = "; ".join(_line(outcome) for outcome in failed)
        raise CutisError(f"{len(failed)} of {len(found)} failed: {listed}")


def _line(outcome: "Outcome") -> str:
    text = str(outcome.failure)
    return text if outcome.face.name in text else f"{outcome.face}: {text}"


def say_all(found: Sequence["Outcome"], output: Path) -> None:
    """Prints a line for each capture of many."""
    from cutis.apps.console import out
    from cutis.report.summary import line

    for outcome in found:
        if outcome.report is not None:
            out.print(f"{outcome.face.name}: {line(outcome.report)}")
    done = sum(outcome.report is not None for outcome in found)
    skipped = sum(outcome.skipped for outcome in found)
    left = f", {skipped} were there already" if skipped else ""
    out.print(f"{done} of {len(found)} estimated into {output}{left}")


def say(report: "Report", face: Path, stem: Path) -> None:
    """Prints what was found in one capture, whose results are called `stem`."""
    from cutis.apps.console import out, print_statistics
    from cutis.report import summary

    for line in summary.before(report):
        out.print(line)
    print_statistics(summary.rows(report))
    for line in summary.after(report, str(face), f"{stem}.skin.exr"):
        out.print(line)
