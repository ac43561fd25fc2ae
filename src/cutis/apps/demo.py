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
    from cutis.apps import estimate
    from cutis.apps.console import out, steps
    from cutis.errors import CutisError
    from cutis.jobs.edit import Job, edit_file
    from cutis.jobs.estimate import Settings, Task, calibrated, estimate_and_show
    from cutis.maps import presets
    from cutis.report.page import write_report
    from cutis.report.previews import reduced
    from cutis.textures import read_texture

    examples = Path(__file__).parents[3] / "examples"
    if not (examples / CAPTURE).is_file():
        raise CutisError(
            "the demo needs a clone of the repository; for your own face: cutis estimate FILE"
        )
    task = Task(examples / CAPTURE, examples / MASK, output, Settings(white="auto"))
    with steps(1, quiet) as progress:
        calibration = calibrated([task], progress.at)
        results, pictures = estimate_and_show(task, calibration, progress.at)
        tanned = Path(f"{task.stem}.tanned.png")
        edit_file(Job(Path(f"{task.stem}.skin.exr"), tanned, presets.tanning), progress.at)
        pictures["edited"] = reduced(read_texture(tanned).linear())
        notes = ["Edited: tanned, melanin +40 %, all of it pheomelanin.", CREDIT]
        write_report(output / "index.html", results, pictures, CAPTURE, notes)
    if not quiet:
        estimate.say(results, task.face, task.stem)
        out.print(f"wrote the tanned face to {tanned}")
        out.print(f"open {output / 'index.html'}")
