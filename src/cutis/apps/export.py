"""`cutis export`: an edit as a LUT that other programs load."""

from pathlib import Path
from typing import Annotated

import typer

from cutis.apps import options


def export(
    output: Annotated[Path, typer.Argument(help="LUT to write, .cube or .clf.")],
    melanin: options.MelaninChange = None,
    blood: options.BloodChange = None,
    thickness: options.ThicknessChange = None,
    eumelanin: options.EumelaninChange = None,
    oxygenation: options.OxygenationChange = None,
    preset: options.Presets = None,
    amount: options.Amount = 1.0,
    size: Annotated[int, typer.Option(help="Nodes along a side, 2 to 129.")] = 65,
    colorspace: Annotated[
        str,
        typer.Option(
            help="What the texture is stored in: sRGB, linear, ACEScg, Display P3, Rec.2020."
        ),
    ] = "sRGB",
    maps: Annotated[
        Path | None,
        typer.Option(help="Maps of a capture, whose calibration and model the LUT takes over."),
    ] = None,
    model: options.ModelName = "default",
    quiet: options.Quiet = False,
) -> None:
    """Write an edit as a three-dimensional LUT.

    For albedo textures with values from 0 to 1. Colours that are no skin's pass through.

    Example: cutis export tan.cube --preset tanning --colorspace ACEScg --size 97
    """
    from cutis.apps.console import out
    from cutis.errors import CutisError
    from cutis.inverse import Calibration
    from cutis.maps import edit_lut, load_maps
    from cutis.textures import write_lut

    edits = options.edits(preset, melanin, blood, thickness, eumelanin, oxygenation)
    if not edits:
        raise CutisError(
            "nothing to export: give --preset or a parameter flag such as --melanin x2"
        )
    calibration = Calibration()
    if maps is not None:
        skin = load_maps(maps)
        calibration = skin.calibration
        model = skin.model if model == "default" else model
    lut = edit_lut(edits, size, colorspace, model=model, calibration=calibration, amount=amount)
    write_lut(output, lut.table, lut.shaper, lut.title)
    if not quiet:
        out.print(f"wrote {output}: {lut.title}, {size} nodes a side, for {lut.space.name}")
