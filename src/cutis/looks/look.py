"""Looks: what somebody decided about a skin, as a small document that does it again anywhere."""

import hashlib
import json
import os
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationError

from cutis.errors import CutisError
from cutis.looks.document import Part, Share, complaint
from cutis.looks.edits import edit_of
from cutis.looks.flags import as_flags
from cutis.looks.folder import Folder
from cutis.looks.layer import GIVEN, Layer, LayerOnFace, Text
from cutis.looks.masks import MaskPart, PaintedPart
from cutis.looks.pictures import GivenPart
from cutis.looks.procedural import PatchesPart
from cutis.maps import Change, Edit, Edits, Face, Recipe, Step, Tile
from cutis.maps.changes import Painted
from cutis.maps.plain import Map
from cutis.maps.source import digest as file_digest
from cutis.textures import replacing
from cutis.textures.problem import shorten
from cutis.textures.regular import read_regular
from cutis.textures.udim import TOKEN, udim_tiles

VERSION: Literal[1] = 1
"""Of the documents that are written here."""
LONGEST = 64 << 20
"""Bytes of a document."""


class Look(Part, Recipe):
    """Layers in order, from the first to the last, each on what those before made of the skin.

    Its masks see the skin as it came to the look. `tissue` names the one that its numbers mean,
    where it has any that are amounts; without, they mean whatever tissue they meet. A look is a
    value: what changes it gives another one.
    """

    cutis_look: Literal[1] = VERSION
    name: Annotated[str, Field(max_length=200)] = ""
    note: Text = ""
    tissue: Annotated[str, Field(max_length=200)] | None = None
    amount: Share = 1.0
    layers: Annotated[tuple[Layer, ...], Field(max_length=1000)] = ()

    _folder: Folder = PrivateAttr(default_factory=Folder)
    _parts: dict[tuple[int, int], "Look"] = PrivateAttr(default_factory=dict)

    def __eq__(self, other: object) -> bool:
        """Of the same document, whose files are seen from the same folder."""
        if not isinstance(other, Look):
            return NotImplemented
        return self.__dict__ == other.__dict__ and self._folder == other._folder

    def __hash__(self) -> int:
        """Equal looks have equal ones."""
        return hash((self.name, self.note, self.amount, len(self.layers)))

    # files ------------------------------------------------------------------------------------

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, allow_outside: bool = False) -> "Look":
        """The look of a file NAME.look.json; the files that it names are seen from its folder.

        They must be in that folder unless `allow_outside`. Loading opens none of them. Raises
        CutisError, one line that names layer and field, for anything that is no look.
        """
        path = Path(path)
        content = read_regular(path, LONGEST)
        look = cls.of_text(content, str(path))
        look._folder = Folder(path.resolve().parent, allow_outside)
        for number, layer in enumerate(look.layers, 1):
            try:
                for part in layer.mask:
                    part.check_names(look._folder)
            except CutisError as error:
                raise CutisError(f"{path}: {look._label(number)}: {error}") from error
        return look

    @classmethod
    def of_text(cls, content: bytes | str, name: str) -> "Look":
        """The look of a document; `name` says in messages which. Raises as `load` does."""
        try:
            document = json.loads(content)
        except (ValueError, RecursionError) as error:
            raise CutisError(f"{name}: is no JSON ({error}); check what wrote it") from error
        if not isinstance(document, dict) or "cutis_look" not in document:
            raise CutisError(f'{name}: is no look: it does not say "cutis_look": {VERSION}')
        found = document["cutis_look"]
        if isinstance(found, int) and found > VERSION:
            raise CutisError(
                f"{name}: is a look of version {found}, and this cutis reads {VERSION}; update it"
            )
        document.pop("$schema", None)
        try:
            return cls.model_validate_json(json.dumps(document), strict=True)
        except ValidationError as error:
            raise CutisError(f"{name}: {complaint(error, document)}") from error

    @property
    def document(self) -> str:
        """The look as JSON on one line, without what is as it is anyway.

        Raises CutisError where a mask is in memory alone.
        """
        return json.dumps(self._as_json(), ensure_ascii=False)

    def _as_json(self) -> dict[str, Any]:
        for number, layer in enumerate(self.layers, 1):
            if any(isinstance(part, GIVEN) for part in layer.mask):
                raise CutisError(
                    f"layer {number}: its mask is not in the look; add it as a picture"
                )
        return self.as_json()

    @property
    def documents(self) -> tuple[str, ...]:
        """The same for a header, with painted masks by name."""
        layers = tuple(layer.without_painted() for layer in self.layers)
        return (self._with(layers).document,)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the look to NAME.look.json, with the names of its files as seen from there."""
        path = Path(path)
        text = json.dumps(
            self.moved(path.resolve().parent)._as_json(), ensure_ascii=False, indent=2
        )
        with replacing(path) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")

    def moved(self, folder: Path) -> "Look":
        """The same with the names of its files as seen from another folder."""
        base = self._folder.path or Path()
        there = Folder(folder, True)
        if base.resolve() == folder:
            layers = self.layers
        else:
            layers = tuple(layer.moved(base, folder) for layer in self.layers)
        return self._with(layers, there)

    @property
    def digest(self) -> str:
        """SHA-256 of the document and of the files that it names."""
        total = hashlib.sha256(self.documents[0].encode())
        for path in self.files():
            total.update(file_digest(path).encode())
        return total.hexdigest()

    def files(self) -> Iterator[Path]:
        """The files that its masks name, of all tiles; CutisError where one is missing."""
        for number, layer in enumerate(self.layers, 1):
            for part in layer.mask if layer.on else ():
                try:
                    for path in part.files(self._folder):
                        tiled = TOKEN in path.name
                        yield from udim_tiles(path).values() if tiled else (path,)
                except CutisError as error:
                    raise CutisError(f"{self._label(number)}: {error}") from error

    # together ----------------------------------------------------------------------------------

    @classmethod
    def of(cls, edits: Edit | Sequence[Edit], name: str = "") -> "Look":
        """A look of one layer that does these edits, whose amounts are numbers."""
        every = (edits,) if isinstance(edits, Edit) else tuple(edits)
        layers = tuple(
            Layer(
                edits=tuple(edit_of(one) for one in group),
                mask=(PatchesPart(),) if where == "patches" else (),
            )
            for where, group in groupby(every, lambda one: one.where)
        )
        return cls(name=name, layers=layers)

    def then(self, other: "Look") -> "Look":
        """Both after each other as one look, whose layers keep the names of their looks."""
        if self == Look():
            return other
        tissues = {one for one in (self.tissue, other.tissue) if one is not None}
        if len(tissues) > 1:
            raise CutisError(f"looks of {' and '.join(sorted(tissues))} do not go into one look")
        parts = (self, other)
        if len({one._folder for one in parts}) > 1:
            parts = (self.moved(Path().resolve()), other.moved(Path().resolve()))
        layers = tuple(layer for one in parts for layer in one._own_layers())
        return Look(tissue=next(iter(tissues), None))._with(layers, parts[0]._folder)

    def _own_layers(self) -> tuple[Layer, ...]:
        """The layers with the look's name and amount in them."""

        def named(layer: Layer) -> Layer:
            names = [one for one in (self.name, layer.name) if one]
            return layer.model_copy(update={"name": ", ".join(names)})

        return tuple(named(layer.within(self.amount, None)) for layer in self.layers)

    def within(self, amount: float, where: Map | Painted | MaskPart | None = None) -> "Look":
        """So much less of the look, inside one more mask, which takes the place of procedural ones.

        The mask is an array (H, W) in 0–1, an open file, or a part of a document.
        """
        Step((), amount, where if isinstance(where, np.ndarray) else None)  # checks both
        part = where if where is None or isinstance(where, MaskPart) else PaintedPart(painted=where)
        return self._with(tuple(layer.within(amount, part) for layer in self.layers))

    def _with(self, layers: tuple[Layer, ...], folder: Folder | None = None) -> "Look":
        """The same with other layers, which need not be such that documents can hold."""
        look = self.model_copy(update={"layers": layers})
        look._folder, look._parts = folder or self._folder, {}
        return look

    def words(self) -> tuple[str, ...]:
        """What it does, a line for each edit of layers that are on."""
        return tuple(line for layer in self._own_layers() if layer.on for line in layer.words())

    def as_flags(self) -> tuple[str, ...]:
        """Arguments of `cutis edit` that do the same; CutisError where flags cannot say it."""
        return as_flags(self._own_layers(), self._label, self._folder.path)

    @classmethod
    def published(cls) -> dict[str, Any]:
        """The JSON Schema of documents, which `docs/look.schema.json` holds."""
        found = cls.model_json_schema()
        found["properties"]["$schema"] = {"type": "string"}
        for part in (found, *found["$defs"].values()):
            says = [name for name, one in part["properties"].items() if "const" in one]
            part["required"] = [*says, *part.get("required", ())]
        return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}

    # on a face ---------------------------------------------------------------------------------

    def for_face(self, face: Face) -> "LookOnFace":
        """The change that the look is on a face.

        Raises CutisError, which names layer and field, where it is of another tissue, where its
        files are missing or of another size, and where it looks at what these maps do not have.
        """
        self._check_tissue(face)
        layers: list[LayerOnFace] = []
        words: list[str] = []
        touched: frozenset[str] = frozenset()
        for number, layer in enumerate(self._own_layers(), 1):
            if not layer.on:
                continue
            label = self._label(number)
            ready = LayerOnFace(layer, face, self._folder, label)
            layers.append(ready)
            words += layer.words()
            for place, edit in enumerate(layer.edits):
                here = face
                if edit.reads & touched:
                    below = LookOnFace((*layers[:-1], ready.first(place)), tuple(words), touched)
                    here = face.after(self._first(number, place), below)
                try:
                    ready.add(edit.on_face(here))
                except CutisError as error:
                    raise CutisError(f"{label}, edit {place + 1}: {error}") from error
                touched |= edit.touches
        return LookOnFace(tuple(layers), tuple(words), touched)

    def check_everywhere(self) -> None:
        """CutisError, which names the layer, where places or neighbours matter."""
        for number, layer in enumerate(self.layers, 1):
            if layer.on and any(part.placed for part in (*layer.edits, *layer.mask)):
                raise CutisError(
                    f"{self._label(number)}: it depends on the place, and a LUT cannot tell places "
                    "apart; switch the layer off, and mask the LUT's result in the other program"
                )

    def _first(self, layer: int, edits: int) -> "Look":
        """The look up to a layer, from 1 on, of which the first edits only; always the same."""
        if (layer, edits) not in self._parts:
            last = self.layers[layer - 1]
            last = last.model_copy(update={"edits": last.edits[:edits]})
            self._parts[layer, edits] = self._with((*self.layers[: layer - 1], last))
        return self._parts[layer, edits]

    def _label(self, number: int) -> str:
        """A layer as messages name it."""
        layer = self.layers[number - 1]
        name = f" ({shorten(layer.name)})" if layer.name else ""
        return f"{f'look {shorten(self.name)}, ' if self.name else ''}layer {number}{name}"

    def _check_tissue(self, face: Face) -> None:
        if self.tissue is None:
            return
        theirs = face.made_by.load().tissue.name
        if theirs == self.tissue:
            return
        for number, layer in enumerate(self.layers, 1):
            parts = (*layer.edits, *layer.mask)
            if layer.on and any(part.absolute for part in parts):
                raise CutisError(
                    f"{self._label(number)}: its numbers are of the tissue {self.tissue}, and "
                    f"these maps of {theirs}; estimate again with a model of {self.tissue}, or "
                    'take "tissue" out of the look if the numbers fit both'
                )


class LookOnFace(Change):
    """A look that is ready for a face."""

    def __init__(
        self, layers: tuple[LayerOnFace, ...], told: tuple[str, ...], touches: frozenset[str]
    ) -> None:
        self._layers, self._told, self._touches = layers, told, touches

    @property
    def reach(self) -> int:
        """Rows above and below a row that decide what becomes of it."""
        return sum(layer.reach for layer in self._layers)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was made of masks."""
        return tuple(dict.fromkeys(note for layer in self._layers for note in layer.notes))

    @property
    def trust(self) -> bool:
        """Whether it looks at σ or confidence."""
        return any(layer.trust for layer in self._layers)

    @property
    def told(self) -> tuple[str, ...]:
        """A line for each edit."""
        return self._told

    @property
    def touches(self) -> frozenset[str]:
        """Names of the maps that it may change."""
        return self._touches

    def __call__(self, tile: Tile) -> Tile:
        """The tile changed."""
        start = tile
        for layer in self._layers:
            tile = layer(start, tile)
        return tile


def asked(edits: Edits, amount: float = 1.0, mask: Path | None = None) -> Recipe:
    """What a job is to do: so much of edits of any kind, inside a mask in a file."""
    wanted = edits if isinstance(edits, Recipe) else Look.of(edits)
    if mask is None:
        return wanted.within(amount)
    if not isinstance(wanted, Look):
        raise CutisError("a change of its own brings its masks with it")
    return wanted.within(amount, GivenPart(path=os.path.abspath(mask)))


def nothing(edits: Edits) -> bool:
    """Whether there is nothing to do."""
    return not edits.layers if isinstance(edits, Look) else isinstance(edits, tuple) and not edits
