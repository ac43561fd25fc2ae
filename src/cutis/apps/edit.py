"""`cutis edit`: maps in, edited albedo out, in the format and depth of the capture."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


@options.parameter_changes
def edit(
    maps: Annotated[Path, typer.Argument(help="Maps that estimate wrote, NAME.skin.exr.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Edited albedo to write.")],
    changes: options.Changes,
    preset: options.Presets = None,
    amount: options.Amount = 1.0,
    mask: options.Mask = None,
    source: options.Source = None,
    illuminant: Annotated[
        str | None,
        typer.Option(
            "--illuminant",
            help="Show the face under this light, balanced on it: a CIE name (A, FL11, LED-B3), "
            "D65-prime, or a CSV of its spectrum.",
        ),
    ] = None,
    method: options.Method = None,
    output_colorspace: options.OutputColorspace = None,
    ocio: options.Ocio = None,
    save_maps: Annotated[
        Path | None, typer.Option(help="Also write the edited maps to this EXR.")
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Edit skin maps and write the albedo with the edit in it.

    Texels that the edit does not change come back bit for bit; --mask paints where it applies. Of
    a UDIM set, give MAPS, the output and --mask as NAME.<UDIM>.EXT.

    Example: cutis edit out/face.skin.exr --melanin x1.4 --blood x0.5 -o tanned.png

    Example: cutis edit out/face.skin.exr --illuminant A -o bulb.png
    """
    from cutis.apps.console import bar, out
    from cutis.jobs.edit import EditJob

    job = EditJob(
        maps, output, options.edits(preset, changes), amount, mask, source,
        light=None if illuminant is None else options.light_of(illuminant),
        model=None if method is None else options.model_of("default", method),
        space=options.space_of(output_colorspace, ocio),
        save_maps=save_maps,
    )  # fmt: skip
    with bar(quiet) as progress:
        found = job.run(progress)
    for one in () if quiet else found:
        for note in one.notes:
            out.say(note)
        for text, clamped in zip(one.edits, one.clamped, strict=True):
            share = f" ({100 * clamped / max(one.inside, 1):.0f} % of the mask)"
            out.say(text + (f", {clamped:,} texels clamped to range{share}" if clamped else ""))
        if illuminant is not None:
            out.say(f"shown under {illuminant}")
        out.say(f"{one.changed:,} texels changed; wrote {one.output}")
