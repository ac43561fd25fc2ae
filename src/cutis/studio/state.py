"""The state of a face, a look, and what may be done to it.

Layers carry a short name of their own beside the document, so that two pages that change different
layers, or different fields of one, do not undo each other's work: what a page sends is what it did,
not what it thinks the look is.
"""

import json
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from cutis.errors import CutisError
from cutis.looks import Look
from cutis.looks.document import MapName
from cutis.looks.edits import MapEdit
from cutis.looks.look import VERSION
from cutis.looks.pictures import FilePart

Id = Annotated[str, Field(pattern=r"^[0-9a-f]{8}$")]
Document = dict[str, Any]


class Op(BaseModel):
    """One thing that a page does."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Add(Op):
    """New layers, from the place `at` on; without it, on top of all."""

    op: Literal["add"]
    layers: Annotated[tuple[Document, ...], Field(min_length=1, max_length=100)]
    at: int | None = None


class Remove(Op):
    """A layer goes."""

    op: Literal["remove"]
    id: Id


class Duplicate(Op):
    """A layer once more, above itself."""

    op: Literal["duplicate"]
    id: Id


class Move(Op):
    """A layer to another place, counted from the lowest."""

    op: Literal["move"]
    id: Id
    to: int


class Put(Op):
    """Another value of one field of a layer."""

    op: Literal["set"]
    id: Id
    field: Literal["name", "note", "on", "amount", "edits", "mask"]
    value: Any


class Tune(Op):
    """The plain edit of one map in a layer: another one, or none.

    It takes the place of the first edit of all of that map; without one it comes last.
    """

    op: Literal["tune"]
    id: Id
    map: MapName
    edit: Document | None


class Paint(Op):
    """One more part of a layer's mask, or another one at a place, or none there."""

    op: Literal["part"]
    id: Id
    at: int | None = None
    part: Document | None


class Brush(Op):
    """A stroke on top of those of a layer's mask, which gets its first with it."""

    op: Literal["stroke"]
    id: Id
    stroke: Document


class Whole(Op):
    """Another look in place of all, as from a file."""

    op: Literal["look"]
    look: Document


AnyOp = Annotated[
    Add | Remove | Duplicate | Move | Put | Tune | Paint | Brush | Whole, Field(discriminator="op")
]


@dataclass(frozen=True)
class State:
    """A look, and the names of its layers in the same order."""

    look: Look = field(default_factory=Look)
    ids: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if len(self.ids) != len(self.look.layers):
            raise CutisError("each layer of a state has a name")

    @classmethod
    def of(cls, look: Look) -> "State":
        """A look whose layers get new names; CutisError where masks are in files."""
        state = cls(look, tuple(_new() for _ in look.layers))
        _no_files(state)
        return state

    def as_json(self) -> Document:
        """For a page."""
        return {"look": self.look.as_json(), "ids": list(self.ids)}

    def place(self, id: str) -> int:
        """Where a layer is; CutisError where it is gone."""
        if id not in self.ids:
            raise CutisError("that layer is gone: another window has removed it, or an undo")
        return self.ids.index(id)

    def after(self, op: Op) -> "State":
        """The state with something done; CutisError, which names the place, where it cannot be."""
        state = self._after(op)
        _no_files(state)
        return state

    def _after(self, op: Op) -> "State":
        layers = [layer.as_json() for layer in self.look.layers]
        ids = list(self.ids)
        if isinstance(op, Whole):
            return State.of(Look.of_text(json.dumps(op.look), "the look"))
        if isinstance(op, Add):
            at = len(layers) if op.at is None else min(max(op.at, 0), len(layers))
            layers[at:at] = list(op.layers)
            ids[at:at] = [_new() for _ in op.layers]
        elif isinstance(op, Move):
            at = self.place(op.id)
            layer, name = layers.pop(at), ids.pop(at)
            to = min(max(op.to, 0), len(layers))
            layers.insert(to, layer)
            ids.insert(to, name)
        elif isinstance(op, Remove):
            at = self.place(op.id)
            del layers[at], ids[at]
        elif isinstance(op, Duplicate):
            at = self.place(op.id)
            layers.insert(at + 1, layers[at])
            ids.insert(at + 1, _new())
        elif isinstance(op, Put | Tune | Paint | Brush):
            at = self.place(op.id)
            layers[at] = _changed(layers[at], op, self)
        document = {**self.look.as_json(), "layers": layers}
        look = Look.of_text(json.dumps(document), "the look")
        return replace(self, look=look, ids=tuple(ids))


def _changed(layer: Document, op: Put | Tune | Paint | Brush, state: State) -> Document:
    if isinstance(op, Put):
        return {**layer, op.field: op.value}
    if isinstance(op, Paint):
        mask = list(layer.get("mask", ()))
        if op.at is None:
            mask += [] if op.part is None else [op.part]
        elif 0 <= op.at < len(mask):
            mask[op.at : op.at + 1] = [] if op.part is None else [op.part]
        else:
            raise CutisError("that part of the mask is gone: another window has removed it")
        return {**layer, "mask": mask}
    if isinstance(op, Brush):
        mask = [dict(part) for part in layer.get("mask", ())]
        painted = [part for part in mask if part.get("part") == "strokes"]
        if not painted:
            painted = [{"part": "strokes"}]
            mask += painted
        painted[-1]["strokes"] = [*painted[-1].get("strokes", ()), op.stroke]
        return {**layer, "mask": mask}
    edits, made = list(layer.get("edits", ())), state.look.layers[state.place(op.id)].edits
    old = [
        i for i, edit in enumerate(made)
        if isinstance(edit, MapEdit) and edit.map == op.map and edit.areas == "all"
    ]  # fmt: skip
    new = [] if op.edit is None else [op.edit]
    if old:
        edits[old[0] : old[0] + 1] = new
    else:
        edits += new
    return {**layer, "edits": edits}


def empty() -> State:
    """What a face starts from: one layer that does nothing yet."""
    return State.of(Look.of_text(json.dumps({
        "cutis_look": VERSION, "layers": [{"name": "Skin"}],
    }), "the look"))  # fmt: skip


def _no_files(state: State) -> None:
    """CutisError where masks name files: pages name none, and a history keeps none."""
    for number, layer in enumerate(state.look.layers, 1):
        if any(isinstance(part, FilePart) for part in layer.mask):
            raise CutisError(
                f"layer {number}: its mask is in a file, which the studio cannot name; paint it as "
                "strokes, or edit with cutis edit --look"
            )


def _new() -> str:
    return secrets.token_hex(4)


def with_ids(document: Mapping[str, Any], ids: tuple[str, ...]) -> State:
    """A state as a history keeps it."""
    return State(Look.of_text(json.dumps(document), "the history"), ids)
