"""Looks as flags of the command line, where flags can say what they do."""

from pathlib import Path

from cutis.errors import CutisError
from cutis.looks import presets
from cutis.looks.edits import Multiply, Offset, Set
from cutis.looks.effect import EditPart
from cutis.looks.layer import Layer
from cutis.looks.look import Look
from cutis.looks.masks import MaskPart
from cutis.looks.pictures import PicturePart
from cutis.looks.tone import LENGTH, Tone

SAVE = "save the look and give --look"


def as_flags(look: Look) -> tuple[str, ...]:
    """The arguments of `cutis edit` that do what a look does: ("--melanin", "x1.4", …).

    Flags have one amount and one mask for all; a preset is said by its name. Raises CutisError,
    which names the layer, where flags cannot say it.
    """
    layers = look._own_layers()
    found: list[str] = []
    shared: set[tuple[float, MaskPart | None]] = set()
    known = [(layer, name) for name in presets.names() for layer in _only(presets.preset(name))]
    for number, layer in enumerate(layers, 1):
        if not layer.on or not layer.edits:
            continue
        try:
            mask = layer.mask
            plain = layer.model_copy(update={"amount": 1.0})
            named = [name for preset, name in known if plain == preset]
            if named:
                found += ["--preset", named[0]]
                mask = ()
            else:
                for edit in layer.edits:
                    found += _flag(edit)
            shared.add((layer.amount, _painted(mask)))
        except CutisError as error:
            raise CutisError(f"{look._label(number)}: {error}") from error
    if len(shared) > 1:
        raise CutisError(f"flags have one amount and one mask for all layers; {SAVE}")
    for amount, part in shared:
        found += [] if amount == 1 else ["--amount", repr(amount)]
        found += [] if part is None else ["--mask", _where(look, part)]
    return tuple(found)


def _only(look: Look) -> tuple[Layer, ...]:
    """The layer of a look of one, as it is in another look."""
    return look._own_layers() if len(look.layers) == 1 and look.amount == 1 else ()


def _flag(edit: EditPart) -> tuple[str, str]:
    if isinstance(edit, Multiply | Offset | Set) and edit.areas == "all":
        value = {Multiply: "x{!r}", Offset: "{:+}", Set: "{!r}"}[type(edit)]
        return f"--{edit.map}", value.format(edit.to if isinstance(edit, Set) else edit.by)
    if isinstance(edit, Tone) and edit.like is None and edit.length == LENGTH:
        return "--tone", str(edit).removeprefix("tone ")
    raise CutisError(f"no flag says {edit}; {SAVE}")


def _painted(mask: tuple[MaskPart, ...]) -> MaskPart | None:
    if not mask:
        return None
    (first, *more) = mask
    if more or not isinstance(first, PicturePart) or first.invert or first.feather is not None:
        raise CutisError(f"flags have masks that are one picture; {SAVE}")
    if first.how == "subtract":
        raise CutisError(f"flags have masks of what is edited, not of what is left out; {SAVE}")
    return first.model_copy(update={"how": "intersect"})


def _where(look: Look, part: MaskPart) -> str:
    assert isinstance(part, PicturePart)
    base = look._folder.path
    return part.path if base is None else str(Path(base) / part.path)
