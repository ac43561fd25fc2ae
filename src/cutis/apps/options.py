"""Flags that mean the same in every command."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.maps import Edit

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
        "--model",
        help="default, measured2026, aliaga2022-exact, aliaga2022, kubelka-munk, or a .safetensors "
        "file of weights.",
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
Bilirubin = Annotated[
    float | None, typer.Option("--bilirubin", help="Bilirubin in the dermis, 0-0.2 g/L.")
]
Carotene = Annotated[
    float | None, typer.Option("--carotene", help="β-carotene in the epidermis, 0-0.05 g/L.")
]
Methaemoglobin = Annotated[
    float | None,
    typer.Option("--methaemoglobin", help="Share of haemoglobin that is methaemoglobin, 0-0.7."),
]
TissueName = Annotated[
    str,
    typer.Option("--tissue", help="measured2026, fitted to measured skin, or aliaga2022."),
]
Presets = Annotated[
    list[str] | None,
    typer.Option("--preset", help="A named edit, before the others; may be repeated."),
]
Amount = Annotated[float, typer.Option("--amount", help="Share of the edit to apply, 0 to 1.")]
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


def _change(name: str, meaning: str) -> typer.models.OptionInfo:
    return typer.Option(
        f"--{name}", help=f"{meaning}: a value, a factor (x1.5) or an offset (+0.1)."
    )


MelaninChange = Annotated[str | None, _change("melanin", "Melanosome volume fraction")]
BloodChange = Annotated[str | None, _change("blood", "Blood volume fraction")]
ThicknessChange = Annotated[str | None, _change("thickness", "Epidermal thickness in µm")]
EumelaninChange = Annotated[str | None, _change("eumelanin", "Eumelanin share of melanin")]
OxygenationChange = Annotated[str | None, _change("oxygenation", "Oxygenated share of haemoglobin")]
BilirubinChange = Annotated[str | None, _change("bilirubin", "Bilirubin in the dermis in g/L")]
CaroteneChange = Annotated[str | None, _change("carotene", "β-carotene in the epidermis in g/L")]
MethaemoglobinChange = Annotated[
    str | None, _change("methaemoglobin", "Methaemoglobin share of haemoglobin")
]


def edits(presets: Sequence[str] | None, flags: Mapping[str, str | None]) -> "list[Edit]":
    """The edits of --preset, in the order given, then those of parameter flags by name."""
    from cutis.maps import parse_edit
    from cutis.maps.presets import preset as named

    found = [change for name in presets or [] for change in named(name)]
    found += [parse_edit(name, text) for name, text in flags.items() if text is not None]
    return found


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
