"""`cutis check`: whether textures are albedos of skin."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def check(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILES...", help="Textures as for estimate: files, NAME.<UDIM>.EXT, folders."
        ),
    ],
    mask: options.Mask = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    strict: Annotated[bool, typer.Option("--strict", help="Notes count as findings.")] = False,
    fix: Annotated[
        bool, typer.Option("--fix", help="Write what can be put right as NAME.fixed.EXT.")
    ] = False,
    thresholds: Annotated[
        Path | None, typer.Option(help="TOML of thresholds that override those that ship.")
    ] = None,
    colorspace: options.Colorspace = "auto",
    ocio: options.Ocio = None,
    orientation: options.Turning = options.Turn.AUTO,
    udim: Annotated[bool, typer.Option("--udim", help="A file is one tile of a set.")] = False,
    quiet: options.Quiet = False,
) -> None:
    """Look whether textures are albedos of skin: colour space, light, casts, gloss, tones, seams.

    Ends with 0 where there are at most notes, 1 where there are findings (with --strict: or notes),
    2 where something could not be checked.

    Example: cutis check textures/ --strict

    Example: cutis check face.png --mask mask.png --json
    """
    from cutis.apps import check_words as words
    from cutis.apps.console import bar
    from cutis.checks.thresholds import thresholds as limits_of
    from cutis.errors import CutisError
    from cutis.jobs.check import CheckJob, check_all, code_of
    from cutis.jobs.inputs import capture_sets, companion
    from cutis.jobs.outcome import CaptureFiles

    try:
        limits, space = limits_of(thresholds), options.source_space(colorspace, ocio)
        said: list[str] = []
        sets = capture_sets(files, udim, False, said.append, results=False)
        jobs = [
            CheckJob(
                tuple(CaptureFiles(f, companion(mask, f)) for f in captures),
                limits=limits, colorspace=space, orientation=orientation.value, fix=fix,
            ) for captures in sets
        ]  # fmt: skip
        with bar(quiet) as progress:
            found = list(check_all(jobs, progress))
    except CutisError as error:
        error.code = words.NOT_CHECKED
        raise
    if as_json:
        words.print_json(found)
    elif not quiet:
        words.say(found, said)
    raise typer.Exit(code_of(found, strict))
