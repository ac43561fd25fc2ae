"""Looks as flags of the command line, where flags can say what they do."""

import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from cutis.errors import CutisError
from cutis.looks.edits import Multiply, Offset, Set
from cutis.looks.effect import EditPart
from cutis.looks.layer import Layer
from cutis.looks.masks import MaskPart
from cutis.looks.pictures import PicturePart
from cutis.looks.shipped import document, names
from cutis.looks.tone import LENGTH, Tone

SAVE = "save the look and give --look"


def as_flags(
    layers: Sequence[Layer], label: Callable[[int], str], folder: Path | None
) -> tuple[str, ...]:
    """The arguments of `cutis edit` that do what layers do: ("--melanin", "x1.4", …).

    Flags have one amount and one mask for all; a preset is said by its name. `label` says which
    layer is meant, from 1 on; `folder` is where names of pictures are seen from. Raises CutisError,
    which names the layer, where flags cannot say it.
    """
    found: list[str] = []
    shared: set[tuple[float, MaskPart | None]] = set()
    known = _presets()
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
            raise CutisError(f"{label(number)}: {error}") from error
    if len(shared) > 1:
        raise CutisError(f"flags have one amount and one mask for all layers; {SAVE}")
    for amount, part in shared:
        found += [] if amount == 1 else ["--amount", repr(amount)]
        if isinstance(part, PicturePart):
            found += ["--mask", part.path if folder is None else str(folder / part.path)]
    return tuple(found)


@cache
def _presets() -> list[tuple[Layer, str]]:
    """Layers of presets of one layer, as they are in a look, with the preset's name."""
    found = []
    for name in names():
        look = json.loads(document(name))
        if len(look["layers"]) == 1:
            layer = Layer.model_validate_json(json.dumps(look["layers"][0]), strict=True)
            title = ", ".join(one for one in (look.get("name", ""), layer.name) if one)
            if look.get("amount", 1) == 1 and layer.amount == 1:
                found.append((layer.model_copy(update={"name": title}), name))
    return found


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
