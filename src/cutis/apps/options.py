"""Flags that mean the same in every command, and how their texts are understood."""

import functools
import inspect
from collections.abc import Callable, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cutis.errors import CutisError

if TYPE_CHECKING:
    from cutis.colour import Light, Space
    from cutis.inverse import Model
    from cutis.inverse.calibration import Exposure as ExposureValue
    from cutis.inverse.calibration import White as WhiteValue
    from cutis.optics import Tissue

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
        help="default, measured2026, measured2026b, aliaga2022-exact, aliaga2022, kubelka-munk, "
        "one that another package brings, or a .safetensors file of weights.",
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
TissueName = Annotated[
    str,
    typer.Option(
        "--tissue", help="measured2026b or measured2026, fitted to measured skin, or aliaga2022."
    ),
]
Amount = Annotated[float, typer.Option("--amount", help="Share of the edit to apply, 0 to 1.")]
Skins = Annotated[
    Path | None,
    typer.Argument(help="CSV of skins, a column per parameter; missing ones are typical."),
]
Source = Annotated[
    Path | None, typer.Option("--source", help="The capture, if it is not where the maps say.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Again = Annotated[
    bool,
    typer.Option("--again", help="Also what is there already, and what was made with other flags."),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster", help="Dask scheduler to work on: tcp://127.0.0.1:8786, tls://host:8786."
    ),
]
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


class Turn(StrEnum):
    """What becomes of orientation tags."""

    AUTO = "auto"
    IGNORE = "ignore"


class Switch(StrEnum):
    """On or off."""

    ON = "on"
    OFF = "off"


Steadiness = Annotated[
    Switch,
    typer.Option(
        "--steady",
        help="on smooths melanin type and oxygenation as far as colours allow, at the cost of "
        "thickness; off finds every texel by itself.",
    ),
]
Turning = Annotated[
    Turn,
    typer.Option(
        "--orientation",
        help="auto turns pictures as their orientation tag says and viewers show them; ignore "
        "keeps the order as stored, for tags that are wrong and meshes that know none.",
    ),
]

Values = dict[str, float]
"""What the flags of `parameter_values` gave, by name."""


def parameter_values(command: Callable[..., None]) -> Callable[..., None]:
    """Gives a command, in place of its argument `values`, a flag for each parameter of a skin."""
    from cutis.optics.parameters import PARAMETERS, RARE

    known = (*PARAMETERS, *RARE)
    flags = [_flag(p.name, float | None, f"--{p.name}", _value_help(p)) for p in known]

    def collect(arguments: dict[str, Any]) -> Values:
        given = {p.name: arguments.pop(p.name) for p in known}
        return {name: value for name, value in given.items() if value is not None}

    return with_flags(command, "values", flags, collect)


def _value_help(known: Any) -> str:
    unit = "" if known.unit == "1" else f" {known.unit}"
    return f"{known.meaning[:1].upper()}{known.meaning[1:]}, {known.low:g}-{known.high:g}{unit}."


def _flag(name: str, kind: Any, flag: str, text: str, default: Any = None) -> inspect.Parameter:
    typed: Any = Annotated[kind, typer.Option(flag, help=text)]
    how = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(name, how, default=default, annotation=typed)


def with_flags(
    command: Callable[..., None],
    slot: str,
    flags: Sequence[inspect.Parameter],
    collect: Callable[[dict[str, Any]], Any],
) -> Callable[..., None]:
    """Gives a command flags in place of its argument `slot`, which gets what `collect` makes.

    `collect` takes the arguments of all flags and removes its own from them.
    """
    signature = inspect.signature(command)

    @functools.wraps(command)
    def wrapped(**arguments: Any) -> None:
        found = collect(arguments)
        command(**arguments, **{slot: found})

    parameters: list[inspect.Parameter] = []
    for one in signature.parameters.values():
        new = flags if one.name == slot else [one]
        parameters += [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in new]
    wrapped.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    wrapped.__annotations__ = {p.name: p.annotation for p in parameters}
    del wrapped.__wrapped__
    return wrapped


# texts, understood once ---------------------------------------------------------------------------


def white_gains(text: str) -> "WhiteValue":
    """The value of --white."""
    if text in ("auto", "none"):
        return "auto" if text == "auto" else "none"
    red, green, blue = _numbers(text, "white", 3)
    return (red, green, blue)


def exposure_gain(text: str) -> "ExposureValue":
    """The value of --exposure."""
    if text in ("auto", "none"):
        return "auto" if text == "auto" else "none"
    return _numbers(text, "exposure", 1)[0]


def model_of(name: str, method: str | None = None, device: str = "cpu") -> "Model":
    """The model of --model, or of --method."""
    from cutis.inverse.lookup import SHAPES
    from cutis.maps import load_model

    if method is None:
        return load_model(name, device)
    if method not in SHAPES:
        raise CutisError(f"--method must be {' or '.join(SHAPES)}, not {method!r}")
    if name != "default":
        raise CutisError("give either --model or --method, not both")
    return load_model(method, device)


def light_of(name: str) -> "Light":
    """The light of --illuminant, which a capture can be balanced on."""
    from cutis.colour import light, light_conversion

    found = light(name)
    light_conversion(found)
    return found


def space_of(name: str | None, ocio: str | None) -> "Space | None":
    """The space of a name; None where none is given."""
    from cutis.textures import colour_space

    return None if name is None else colour_space(name, ocio)


def source_space(name: str, ocio: str | None) -> "Space | None":
    """The space of --colorspace; None for what the file says."""
    return None if name == "auto" else space_of(name, ocio)


def tissue_of(name: str) -> "Tissue":
    """The tissue of --tissue."""
    from cutis.optics import tissue_named

    return tissue_named(name)


def wavelength_range(text: str) -> tuple[float, float]:
    """The value of --range."""
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        low, high = 1.0, 0.0
    if not 0 < low < high:
        raise CutisError(f"--range takes two wavelengths in nm like 400,700, not {text!r}")
    return low, high


def sizes(text: str, name: str) -> tuple[int, ...]:
    """The value of --grid or --tensor."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise CutisError(
            f"--{name} takes five whole numbers like 8,8,3,1,1, not {text!r}"
        ) from None


def incidence(text: str) -> float | Literal["lambertian"] | str:
    """The value of --incidence."""
    from cutis.transport.quadrature import beam_cosine

    try:
        value: float | str = "lambertian" if text == "lambertian" else float(text)
    except ValueError:
        raise CutisError(
            f"--incidence takes lambertian or the cosine of a beam, not {text!r}"
        ) from None
    beam_cosine(value)
    return value


def _numbers(text: str, name: str, count: int) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count:
        form = "three gains like 0.9,1,1.1" if count == 3 else "one gain like 1.2"
        raise CutisError(f"--{name} takes none, auto or {form}, not {text!r}")
    return values
