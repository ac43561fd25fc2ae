"""`cutis export`: an edit as a LUT, or a model's networks, for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options
from cutis.apps.edit_flags import Changes, edit_flags


@edit_flags
def export(
    output: Annotated[
        Path,
        typer.Argument(
            help="An edit as NAME.cube or NAME.clf; a model as decoder.onnx, decoder.glsl or "
            "encoder.onnx."
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
    quiet: options.Quiet = False,
) -> None:
    """Write an edit as a LUT, or a model as ONNX or GLSL, for other programs.

    A LUT is for the capture whose --maps are given, or for captures that need no calibration.
    Colours far from skin pass through.

    Example: cutis export tan.clf --preset tanning --colorspace ACEScg --maps out/face.skin.exr
    """
    from cutis.apps.console import bar, out
    from cutis.colour import SRGB
    from cutis.jobs.export import ExportJob

    job = ExportJob(
        output, changes.look(), amount, size,
        options.space_of(colorspace, ocio) or SRGB, maps,
        None if model is None else options.model_of(model),
    )  # fmt: skip
    with bar(quiet) as progress:
        said = job.run(progress)
    if not quiet:
        out.say(f"wrote {output}: {said}")
