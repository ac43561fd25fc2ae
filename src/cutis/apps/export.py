"""`cutis export`: an edit as a LUT, or a model's networks, for other programs."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.maps import Edit

NETWORKS = (".onnx", ".glsl")
"""Extensions that a model's networks are written in."""


def export(
    output: Annotated[
        Path,
        typer.Argument(
            help="An edit as NAME.cube or NAME.clf; the networks as decoder.onnx, encoder.onnx or "
            "decoder.glsl."
        ),
    ],
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
        typer.Option(help="As in estimate; networks are those of aliaga2022 or a .safetensors."),
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Write an edit as a LUT, or the networks as ONNX or GLSL, for other programs.

    A LUT is for the capture whose --maps are given, or for captures that need no calibration.
    Colours far from skin pass through.

    Example: cutis export tan.clf --preset tanning --colorspace ACEScg --maps out/face.skin.exr
    """
    from cutis.apps.console import out
    from cutis.errors import CutisError

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
    if output.suffix.lower() in NETWORKS:
        if edits or maps is not None:
            raise CutisError(f"{output} is for networks; edits are written as .cube or .clf")
        said = _networks(output, model or "aliaga2022")
    else:
        said = _edit(output, edits, size, colorspace, maps, model, amount, ocio)
    if not quiet:
        out.print(f"wrote {output}: {said}")


def _edit(
    output: Path,
    edits: "list[Edit]",
    size: int,
    colorspace: str,
    maps: Path | None,
    model: str | None,
    amount: float,
    ocio: str | None,
) -> str:
    from cutis.errors import CutisError
    from cutis.inverse import Calibration
    from cutis.luts import export_lut
    from cutis.maps import MapsFile
    from cutis.textures import colour_space

    if not edits:
        raise CutisError(
            "nothing to export: give --preset or a parameter flag such as --melanin x2"
        )
    space = colour_space(colorspace, ocio)
    calibration, chosen = Calibration(), model or "default"
    if maps is not None:
        with MapsFile(maps) as file:
            calibration, chosen = file.calibration, model or file.model
    title = export_lut(
        output, edits, space, size, model=chosen, calibration=calibration, amount=amount
    )
    return f"{title}, {size} nodes a side"


def _networks(output: Path, model: str) -> str:
    from cutis.errors import CutisError
    from cutis.inverse.models import networks
    from cutis.inverse.onnx_export import decoder_onnx, encoder_onnx
    from cutis.inverse.shader_export import decoder_glsl
    from cutis.textures import replacing

    pair = networks(model)
    half = "encoder" if "encoder" in output.stem.lower() else "decoder"
    name = Path(model).name
    if output.suffix.lower() == ".onnx":
        content = encoder_onnx(pair) if half == "encoder" else decoder_onnx(pair)
    elif half == "encoder":
        raise CutisError(f"{output}: only the decoder is written as GLSL; the encoder as .onnx")
    else:
        content = decoder_glsl(pair.decoder, f"The decoder of {name}, from cutis.").encode("utf-8")
    with replacing(output) as temporary:
        temporary.write_bytes(content)
    return f"{half} of {name}"
