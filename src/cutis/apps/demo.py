"""`cutis demo`: the whole pipeline on the bundled capture, and a page that shows it."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options

CAPTURE = "bioskin_capture1.jpg"
MASK = "bioskin_capture1_mask.jpg"
CREDIT = "Capture © Meta Platforms, MIT licence, from BioSkin; see examples/README.md."


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.")] = Path(
        "demo"
    ),
    quiet: options.Quiet = False,
) -> None:
    """Estimate, edit and show the capture that comes with the repository.

    Example: cutis demo -o demo
    """
    from cutis.apps.console import bar, out
    from cutis.apps.estimate_words import say_one
    from cutis.errors import CutisError
    from cutis.jobs.edit import EditJob
    from cutis.jobs.estimate import EstimateJob
    from cutis.jobs.job import part
    from cutis.jobs.outcome import CaptureFiles
    from cutis.looks import tone_look
    from cutis.report.page import write_report
    from cutis.report.previews import previews_of, reduced
    from cutis.textures import read_texture

    examples = Path(__file__).parents[3] / "examples"
    if not (examples / CAPTURE).is_file():
        raise CutisError(
            "the demo needs a clone of the repository; for your own face: cutis estimate FILE"
        )
    capture = CaptureFiles(examples / CAPTURE, examples / MASK)
    job = EstimateJob((capture,), output, white="auto", again=True)
    with bar(quiet) as progress:
        (found,) = job.run(part(progress, 0, 2))
        if found.report is None:
            raise CutisError(str(found.failure))
        darker = Path(f"{job.stem(capture)}.darker.png")
        maps = Path(f"{job.stem(capture)}.skin.exr")
        EditJob(maps, darker, tone_look("ita:-10")).run(part(progress, 1, 2))
        pictures = {**previews_of(maps), "edited": reduced(read_texture(darker).linear())}
        notes = ["Edited: the same face in another tone, ITA° -10 (--tone ita:-10).", CREDIT]
        write_report(output / "index.html", found.report, pictures, CAPTURE, notes)
    if not quiet:
        say_one(found.report, capture.face, maps)
        out.say(f"wrote the face in another tone to {darker}")
        out.say(f"open {output / 'index.html'}")
