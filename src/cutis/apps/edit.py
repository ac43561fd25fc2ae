"""`cutis edit`: maps in, edited albedo out, in the format and depth of the capture."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options
from cutis.apps.edit_flags import Changes, edit_flags

if TYPE_CHECKING:
    from cutis.jobs.edit import EditJob
    from cutis.looks import Look
    from cutis.optics import Tissue


@edit_flags
def edit(
    maps: Annotated[Path, typer.Argument(help="Maps that estimate wrote, NAME.skin.exr.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Edited albedo to write.")],
    changes: Changes,
    amount: Annotated[
        str,
        typer.Option(
            "--amount",
            help="Share of the edit to apply, 0 to 1; 0..1 writes --frames pictures of it growing.",
        ),
    ] = "1",
    frames: Annotated[
        int | None,
        typer.Option("--frames", help="Pictures of a range of amounts: NAME.0001.EXT, …; 24."),
    ] = None,
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
    model: Annotated[
        str | None,
        typer.Option("--model", help="Of maps that lost theirs in another program."),
    ] = None,
    method: options.Method = None,
    calibration: Annotated[
        str | None,
        typer.Option(
            "--calibration",
            help="Of maps that lost theirs: three gains (0.9,1,1.1) or NAME.report.json.",
        ),
    ] = None,
    output_colorspace: options.OutputColorspace = None,
    ocio: options.Ocio = None,
    save_maps: Annotated[
        Path | None, typer.Option(help="Also write the edited maps to this EXR.")
    ] = None,
    save_look: Annotated[
        Path | None, typer.Option(help="Also write all that is done as a look, NAME.look.json.")
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Edit skin maps and write the albedo with the edit in it.

    Presets, looks, tones and parameter flags apply in the order typed; --amount and --mask hold for
    all of them. Texels that the edit does not change come back bit for bit. Of a UDIM set, give
    MAPS, the output and --mask as NAME.<UDIM>.EXT.

    Example: cutis edit out/face.skin.exr --melanin x1.4 --blood x0.5 -o tanned.png

    Example: cutis edit out/face.skin.exr --look burn.look.json --melanin x1.2 -o burnt.png

    Example: cutis edit out/face.skin.exr --tone monk:7 -o another.png

    Example: cutis edit out/face.skin.exr --illuminant A -o bulb.png

    Example: cutis edit out/face.skin.exr --preset flushing --amount 0..1 --frames 24 -o flush.png
    """
    from cutis.apps.console import bar, out
    from cutis.errors import CutisError
    from cutis.jobs.edit import EditJob
    from cutis.jobs.edit_frames import EditFramesJob, amounts_of
    from cutis.maps.lost import given_calibration
    from cutis.report.words import percent

    named = model is not None or calibration is not None
    if not (changes or illuminant or (named and save_maps)) and not edited_before(maps):
        raise CutisError(
            "there is nothing to do: give --preset tanning, --look NAME.look.json, --tone ita:-20, "
            "a parameter flag such as --melanin x1.4, or --illuminant A"
        )
    look, amounts = changes.look(), amounts_of(amount, frames)
    job = EditJob(
        maps, output, look, amounts[0], mask, source,
        light=None if illuminant is None else options.light_of(illuminant),
        model=None if method is None and model is None else options.model_of(
            model or "default", method
        ),
        calibration=None if calibration is None else given_calibration(
            calibration, tissue_of(maps, model)
        ),
        space=options.space_of(output_colorspace, ocio),
        save_maps=save_maps,
    )  # fmt: skip
    if save_look is not None and len(amounts) > 1:
        raise CutisError("a look has one amount: give --save-look without a range of amounts")
    if len(amounts) > 1:
        sequence = EditFramesJob(job, amounts)
        with bar(quiet) as progress:
            pictures = sequence.run(progress)
        if not quiet:
            film = "" if pictures.film is None else f" and {pictures.film}"
            out.say(f"wrote {len(pictures.pictures)} pictures{film}")
        return
    with bar(quiet) as progress:
        found = job.run(progress)
    if save_look is not None:
        write_look(look, save_look, amounts[0], mask, job)
    for one in () if quiet else found:
        for note in one.notes:
            out.say(note)
        for text, clamped in zip(one.edits, one.clamped, strict=True):
            share = f" ({percent(clamped / max(one.inside, 1))} of the mask)"
            out.say(text + (f", {clamped:,} texels clamped to range{share}" if clamped else ""))
        if illuminant is not None:
            out.say(f"shown under {illuminant}")
        out.say(f"{one.changed:,} texels changed; wrote {one.output}")


def tissue_of(maps: Path, model: str | None) -> "Tissue":
    """The tissue of a model by its name, or of the model that maps say they were made by."""
    if model is not None:
        return options.model_of(model).tissue
    from cutis.maps import MapsFile

    with MapsFile(first_of(maps)) as file:
        return file.made_by.load().tissue


def first_of(maps: Path) -> Path:
    """The first tile of a set; the file itself otherwise."""
    from cutis.textures.udim import TOKEN, udim_tiles

    return next(iter(udim_tiles(maps).values())) if TOKEN in maps.name else maps


def edited_before(maps: Path) -> bool:
    """Whether maps hold edits already, which are written with no others too."""
    from cutis.maps import MapsFile

    with MapsFile(first_of(maps)) as file:
        return bool(file.header.edits or file.header.changed)


def write_look(look: "Look", path: Path, amount: float, mask: Path | None, job: "EditJob") -> None:
    """Writes all that was asked for as one look, whose numbers are of the tissue of the maps."""
    from cutis.apps.console import out
    from cutis.looks import PicturePart
    from cutis.maps import MapsFile

    part = None if mask is None else PicturePart(path=mask.as_posix())
    whole = look.moved(Path().resolve()).within(amount, part)
    if whole.tissue is None:
        with MapsFile(job.tiles()[0].maps) as maps:
            whole = whole.model_copy(update={"tissue": maps.made_by.load().tissue.name})
    whole.save(path)
    if any(not name.is_relative_to(path.resolve().parent) for name in whole.files()):
        out.say(f"{path} names masks outside its folder: load it with --allow-outside")
