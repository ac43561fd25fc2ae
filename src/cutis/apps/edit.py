"""`cutis edit`: maps in, edited albedo out, in the format and depth of the capture."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def edit(
    maps: Annotated[Path, typer.Argument(help="Maps that estimate wrote, NAME.skin.exr.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Edited albedo to write.")],
    melanin: options.MelaninChange = None,
    blood: options.BloodChange = None,
    thickness: options.ThicknessChange = None,
    eumelanin: options.EumelaninChange = None,
    oxygenation: options.OxygenationChange = None,
    bilirubin: options.BilirubinChange = None,
    carotene: options.CaroteneChange = None,
    methaemoglobin: options.MethaemoglobinChange = None,
    preset: options.Presets = None,
    amount: options.Amount = 1.0,
    mask: options.Mask = None,
    source: Annotated[
        Path | None, typer.Option(help="The capture, if it is not where the maps say.")
    ] = None,
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
    from cutis.apps.console import out, steps
    from cutis.colour import light_conversion
    from cutis.errors import CutisError
    from cutis.jobs.edit import Job, edit_file
    from cutis.textures import colour_space, format_of
    from cutis.textures.udim import TOKEN, tile_of, udim_tiles

    by_tensor = None if method is None else options.method_name(method)
    flags = {
        "melanin": melanin,
        "blood": blood,
        "thickness": thickness,
        "eumelanin": eumelanin,
        "oxygenation": oxygenation,
        "bilirubin": bilirubin,
        "carotene": carotene,
        "methaemoglobin": methaemoglobin,
    }
    edits = options.edits(preset, flags)
    format_of(output)  # fails now rather than after the work
    space = None if output_colorspace is None else colour_space(output_colorspace, ocio)
    if illuminant is not None:
        light_conversion("D65", illuminant)  # fails now too
    job = Job(
        maps, output, tuple(edits), amount, mask, source, by_tensor, space, save_maps, illuminant
    )
    jobs = [job]
    if TOKEN in maps.name:
        named_all = [path for path in (output, save_maps, source) if path is not None]
        for path in named_all:
            if TOKEN not in path.name:
                raise CutisError(f"{path}: of a UDIM set, name it with {TOKEN} too")
        jobs = [job.tile(number, tile_of) for number in udim_tiles(maps)]
    found = []
    with steps(len(jobs), quiet) as progress:
        for number, one in enumerate(jobs):

            def of_all(done: int, total: int, name: str, number: int = number) -> None:
                progress.at(int(1000 * (number + done / total)), 1000 * len(jobs), name)

            found.append(edit_file(one, of_all))
    if quiet:
        return
    for one, result in zip(jobs, found, strict=True):
        for text, clamped in zip(result.edits, result.clamped, strict=True):
            share = f" ({100 * clamped / max(result.inside, 1):.0f} % of the mask)"
            note = f", {clamped:,} texels clamped to range{share}" if clamped else ""
            out.print(f"{text}{note}")
        if illuminant is not None:
            out.print(f"shown under {illuminant}")
        out.print(f"{result.changed:,} texels changed; wrote {one.output}")
