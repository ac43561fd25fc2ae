"""`cutis export`: an edit as a LUT, or a model's networks, for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options
from cutis.apps.edit_flags import Changes, edit_flags
from cutis.errors import CutisError


@edit_flags
def export(
    output: Annotated[
        Path,
        typer.Argument(
            help="An edit as NAME.cube or NAME.clf; a model as decoder.onnx, decoder.glsl or "
            "encoder.onnx; with --for or --delta a folder."
        ),
    ],
    changes: Changes,
    amount: options.Amount = 1.0,
    size: Annotated[int, typer.Option(help="Nodes along a side of a LUT, at most 129.")] = 65,
    colorspace: Annotated[
        str,
        typer.Option(
            help="What textures are stored in: sRGB, linear, ACEScg, Display P3, Rec.2020, or a "
            "name of OpenColorIO."
        ),
    ] = "sRGB",
    ocio: options.Ocio = None,
    maps: Annotated[
        Path | None,
        typer.Option(help="Maps of a capture, whose calibration and model the LUT takes over."),
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(help="As in estimate; encoder.onnx needs one of networks: aliaga2022."),
    ] = None,
    engine: Annotated[
        str | None,
        typer.Option("--for", help="Make a folder of --maps that drops into: game."),
    ] = None,
    delta: Annotated[
        bool,
        typer.Option("--delta", help="What each look does to the albedo of --maps, as textures."),
    ] = False,
    source: options.Source = None,
    quiet: options.Quiet = False,
) -> None:
    """Write an edit as a LUT, or a model as ONNX or GLSL, for other programs.

    A LUT is for the capture whose --maps are given, or for captures that need no calibration.
    Colours far from skin pass through.

    Example: cutis export face_game/ --for game --maps out/face.skin.exr

    Example: cutis export tan.clf --preset tanning --colorspace ACEScg --maps out/face.skin.exr

    Example: cutis export deltas --delta --preset flushing --look a.look.json --maps face.skin.exr
    """
    from cutis.apps.console import bar, out
    from cutis.colour import SRGB
    from cutis.jobs.delta import DeltaJob
    from cutis.jobs.export import ExportJob
    from cutis.jobs.package import PackageJob

    if delta and engine is not None:
        raise CutisError("--for and --delta make two folders: give one of them at a time")
    if delta:
        if maps is None:
            raise CutisError("--delta is of a face: give its maps with --maps NAME.skin.exr")
        work = DeltaJob(maps, output, tuple(one.within(amount) for one in changes.each()), source)
        with bar(quiet) as progress:
            files = work.run(progress)
        if not quiet:
            out.say(f"wrote {', '.join(file.name for file in files)} into {output}")
        return
    if source is not None:
        raise CutisError("--source is of --delta; a LUT needs no capture")

    job: ExportJob | PackageJob
    if engine is None:
        job = ExportJob(
            output, changes.look(), amount, size,
            options.space_of(colorspace, ocio) or SRGB, maps,
            None if model is None else options.model_of(model),
        )  # fmt: skip
    elif maps is None:
        raise CutisError("--for needs --maps, the NAME.skin.exr that the folder is made of")
    elif changes:
        raise CutisError(
            "--for takes maps as they are: write edited ones with cutis edit --save-maps first"
        )
    else:
        job = PackageJob(output, engine, maps)
    with bar(quiet) as progress:
        said = job.run(progress)
    if not quiet:
        out.say(f"wrote {output}: {said}")
