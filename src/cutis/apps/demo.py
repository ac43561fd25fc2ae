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
    from cutis.apps.page import write_page
    from cutis.apps.previews import write_colour
    from cutis.errors import CutisError
    from cutis.maps import presets
    from cutis.textures import write_texture

    examples = Path(__file__).parents[3] / "examples"
    if not (examples / CAPTURE).is_file():
        raise CutisError(
            "the demo needs a clone of the repository; for your own face: cutis estimate FILE"
        )
    with steps(8, quiet) as progress:
        skin, texture, results = estimate.run(
            examples / CAPTURE, output, examples / MASK, "auto", "none", "default", "auto", False,
            progress.step,
        )  # fmt: skip
        stem = output / Path(CAPTURE).stem
        progress.step("tanning")
        tanned = skin.apply(presets.tanning)
        write_texture(tanned.retouch(texture), f"{stem}.tanned.png")
        progress.step("writing the page")
        assert skin.source is not None
        write_colour(Path(f"{stem}.source.preview.png"), skin.source)
        write_colour(Path(f"{stem}.model.preview.png"), skin.model_albedo)
        write_colour(Path(f"{stem}.tanned.preview.png"), tanned.albedo())
        page = output / "index.html"
        write_page(page, stem, results, CREDIT)
    if not quiet:
        estimate.say(results, skin)
        out.print(f"open {page}")
