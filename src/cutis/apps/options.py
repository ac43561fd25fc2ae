"""Flags that mean the same in every command."""

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Literal

import typer

from cutis.errors import CutisError

Mask = Annotated[
    Path | None, typer.Option("--mask", help="Grey image, white where it applies, same size.")
]
White = Annotated[
    str, typer.Option("--white", help="none, auto, or three gains for red,green,blue: 0.9,1,1.1.")
]
Exposure = Annotated[str, typer.Option("--exposure", help="none, auto, or one gain: 1.2.")]
ModelName = Annotated[
    str,
    typer.Option(
        "--model", help="default, aliaga2022, kubelka-munk, or a .safetensors file of weights."
    ),
]
Method = Annotated[
    str | None,
    typer.Option("--method", help="lookup or lookup-55k: a look-up tensor instead of a model."),
]
Illuminant = Annotated[
    str,
    typer.Option(
        "--illuminant",
        help="Light of the capture: a CIE name (A, D50, FL11, LED-B3), D65-prime, or a CSV of its "
        "spectrum.",
    ),
]
Melanin = Annotated[
    float | None, typer.Option("--melanin", help="Melanosome volume fraction, 0.001-1.")
]
Blood = Annotated[float | None, typer.Option("--blood", help="Blood volume fraction, 0.001-1.")]
Thickness = Annotated[
    float | None, typer.Option("--thickness", help="Epidermal thickness, 10-250 µm.")
]
Eumelanin = Annotated[float | None, typer.Option("--eumelanin", help="Eumelanin share of melanin.")]
Oxygenation = Annotated[
    float | None, typer.Option("--oxygenation", help="Oxygenated share of haemoglobin.")
]
Skins = Annotated[
    Path | None,
    typer.Argument(help="CSV of skins, a column per parameter; missing ones are typical."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Colorspace = Annotated[
    str,
    typer.Option(
        "--colorspace",
        help="Colour space of the capture: auto (what the file says), sRGB, linear, ACEScg, "
        "Display P3, Rec.2020, or an OpenColorIO name, role or alias.",
    ),
]
OutputColorspace = Annotated[
    str | None,
    typer.Option(
        "--output-colorspace",
        help="Colour space to write: names as for --colorspace. By default edit keeps the "
        "capture's, and estimate writes NAME.model.exr in linear sRGB.",
    ),
]
Ocio = Annotated[
    str | None,
    typer.Option(
        "--ocio", help="OpenColorIO configuration; by default $OCIO, else the ACES studio one."
    ),
]


def white_gains(text: str) -> Literal["none", "auto"] | Sequence[float]:
    """The value of --white."""
    return "auto" if text == "auto" else "none" if text == "none" else _numbers(text, "white", 3)


def exposure_gain(text: str) -> Literal["none", "auto"] | float:
    """The value of --exposure."""
    return (
        "auto" if text == "auto" else "none" if text == "none" else _numbers(text, "exposure", 1)[0]
    )


def method_name(text: str) -> str:
    """The value of --method, as the name of a model."""
    from cutis.inverse.lookup import SHAPES

    if text not in SHAPES:
        raise CutisError(f"--method must be {' or '.join(SHAPES)}, not {text!r}")
    return text


def make_folder(folder: Path) -> None:
    """Makes the folder of the results; CutisError where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise CutisError(f"{folder}: cannot make this folder ({reason.lower()})") from error


@contextlib.contextmanager
def made_folder(folder: Path) -> Iterator[None]:
    """The same; folders that it made go again if the block fails and leaves them empty."""
    new = [one for one in (folder, *folder.parents) if not one.exists()]
    make_folder(folder)
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError):
            for one in new:
                one.rmdir()
        raise


def _numbers(text: str, name: str, count: int) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count:
        form = "three gains like 0.9,1,1.1" if count == 3 else "one gain like 1.2"
        raise CutisError(f"--{name} takes none, auto or {form}, not {text!r}")
    return values
