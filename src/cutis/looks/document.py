"""What every part of a look's document has in common, and what is said where one is wrong."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cutis.errors import CutisError
from cutis.textures.problem import shorten

MapName = Literal[
    "melanin", "blood", "thickness", "eumelanin", "oxygenation",
    "bilirubin", "carotene", "methaemoglobin",
]  # fmt: skip
"""The five maps and those of rare chromophores, as `optics` names them."""
Share = Annotated[float, Field(ge=0, le=1)]
_Texels = Annotated[str, Field(pattern=r"^([1-9]\d{0,3}(\.\d{1,3})?|0\.[1-9]\d{0,2})px$")]
Radius = Annotated[
    Annotated[float, Field(gt=0, le=0.5)] | _Texels,
    Field(
        description="The standard deviation of a Gaussian: a fraction of the texture's longer "
        'side, above 0 to 0.5, or texels as "12px".'
    ),
]  # fmt: skip


class Part(BaseModel):
    """A part of a document: a value that cannot be changed, without fields that nobody knows."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def as_json(self) -> dict[str, Any]:
        """As JSON holds it: what it is first, then what is not as it is anyway."""
        found: dict[str, Any] = {}
        for name, known in type(self).model_fields.items():
            value = getattr(self, name)
            if name in KINDS or value != known.get_default(call_default_factory=True):
                found[name] = _plain(value)
        return {name: found[name] for name in sorted(found, key=lambda one: one not in KINDS)}


KINDS = ("cutis_look", "do", "part")
"""Fields that say what a part is."""


def _plain(value: Any) -> Any:
    if isinstance(value, Part):
        return value.as_json()
    return [_plain(one) for one in value] if isinstance(value, tuple) else value


def texels(radius: float | str, shape: tuple[int, int]) -> float:
    """A radius in texels of a texture (H, W)."""
    if isinstance(radius, str):
        return float(radius.removesuffix("px"))
    return radius * max(shape)


def complaint(error: ValidationError, document: Any) -> CutisError:
    """What is wrong with a document first, in one line that names the place in it."""
    found = error.errors(include_url=False)
    # of a value that may be of several kinds, what is wrong with its own kind comes first
    first = min(found, key=lambda one: one["type"] in _KINDS)
    place, value = _place(first["loc"], document), first.get("input")
    what = _said(first["type"], first["msg"], first.get("ctx") or {}, value)
    return CutisError(f"{place}: {what}" if place else what)


_KINDS = {"float_type", "int_type", "string_type", "bool_type", "tuple_type", "model_type"}
_LISTS = {"layers": "layer", "edits": "edit", "mask": "mask part", "strokes": "stroke",
          "points": "point"}  # fmt: skip


def _place(where: Sequence[str | int], document: Any) -> str:
    """`("layers", 1, "edits", 0, "multiply", "by")` → "layer 2 (flush), edit 1, by"."""
    said: list[str] = []
    here, name = document, ""
    for step in where:
        if isinstance(step, int) and isinstance(here, list) and step < len(here):
            here = here[step]
            told = here.get("name") if isinstance(here, Mapping) else None
            label = f" ({shorten(told)})" if isinstance(told, str) and told else ""
            said.append(f"{_LISTS.get(name, name) or 'number'} {step + 1}{label}")
            name = ""
        elif isinstance(step, str) and isinstance(here, Mapping) and step in here:
            said += [name] if name else []
            here, name = here[step], step
        elif step == where[-1] and isinstance(step, str) and isinstance(here, Mapping):
            name = step  # a field that is missing
    return ", ".join([*said, *([name] if name else [])])


def _said(kind: str, message: str, context: Mapping[str, Any], value: Any) -> str:
    if kind == "missing":
        return "is missing"
    if kind == "extra_forbidden":
        return "unknown field; leave it out, or update cutis if the look is newer"
    if kind == "union_tag_not_found":
        return f"has no {context.get('discriminator')}, which says what it is"
    if kind == "union_tag_invalid":
        return f"unknown kind {context.get('tag')!r}; use one of {context.get('expected_tags')}"
    if kind == "value_error":
        return shorten(str(context.get("error")))
    text = message.replace("Input should be", "must be").replace("String should", "must")
    told = "" if isinstance(value, list | dict | tuple) else f", not {shorten(repr(value))}"
    return f"{text[:1].lower()}{text[1:]}{told}"
