"""Masks out of pictures: grey ones, and regions in flat colours."""

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cutis.looks.folder import Folder
from cutis.looks.masks import Cover, MaskPart, NamedPart
from cutis.looks.window import Window
from cutis.maps import Face, Tile
from cutis.maps.plain import Map
from cutis.textures import LabelFile, MaskFile
from cutis.textures.texture import bands
from cutis.textures.udim import TOKEN

Name = Annotated[str, Field(min_length=1, max_length=1000)]
COLOUR = r"^#[0-9a-fA-F]{6}$"


class FilePart(MaskPart):
    """A part that is in a file."""

    path: Name = Field(description="Seen from the folder of the look; NAME.<UDIM>.EXT for sets.")

    def files(self, folder: Folder) -> tuple[Path, ...]:
        """The picture."""
        return (folder.find(self.path),)

    def check_names(self, folder: Folder) -> None:
        """CutisError where the picture is outside a folder that names may not lead out of."""
        folder.place(self.path)

    def moved(self, old: Path, new: Path) -> "FilePart":
        """The same with its name as seen from another folder."""
        path = os.path.relpath(old.resolve() / self.path, new)
        return self.model_copy(update={"path": Path(path).as_posix()})


class PicturePart(FilePart):
    """A grey picture of the texture's size, white where the layer applies."""

    part: Literal["picture"] = "picture"

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The picture of this face; CutisError where it is missing, of another size or black."""
        path = folder.find(self.path, face.number)
        frame, how = face.frame, face.orientation
        with MaskFile(path, frame, how) as file:
            notes = file.notes
            marked = TOKEN in self.path or any(
                (file.rows(rows) > MaskFile.BLACK).any() for rows in bands(face.shape)
            )
            if not marked:
                raise file.empty()
        return _Picture(lambda: MaskFile(path, frame, how), lambda found: found, notes)


class GivenPart(PicturePart):
    """A picture that somebody named beside the look: it may be anywhere."""

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The picture of this face; see `PicturePart`."""
        return super().on_face(face, Folder())

    def check_names(self, folder: Folder) -> None:
        """It may be anywhere."""

    def named(self) -> MaskPart:
        """What a header keeps of it: its name."""
        return NamedPart(how=self.how, file=Path(self.path).name)


class RegionsPart(FilePart):
    """Regions of a picture in flat colours: those that are taken, by colour or by name."""

    part: Literal["regions"] = "regions"
    take: Annotated[tuple[Name, ...], Field(min_length=1, max_length=256)] = Field(
        description="Colours as #rrggbb, or names of `names`."
    )
    names: dict[Name, Annotated[str, Field(pattern=COLOUR)]] = Field(
        default_factory=dict, description="What colours are called: a colour as #rrggbb by name."
    )

    @model_validator(mode="after")
    def _known(self) -> "RegionsPart":
        for one in self.take:
            if one not in self.names and not re.match(COLOUR, one):
                known = ", ".join(self.names) or "none"
                raise ValueError(
                    f"{one!r} is no colour like #c03030 and no name; names are {known}"
                )
        return self

    def on_face(self, face: Face, folder: Folder) -> Cover:
        """The picture of this face; CutisError where it is missing, lossy or of another size."""
        path = folder.find(self.path, face.number)
        colours = [int(self.names.get(one, one)[1:], 16) for one in self.take]
        frame, how = face.frame, face.orientation
        with LabelFile(path, frame, how) as file:
            notes = file.notes

        def taken(labels: Any) -> Map:
            return np.isin(labels, colours).astype(np.float32)

        return _Picture(lambda: LabelFile(path, frame, how), taken, notes)


class _Picture(Cover):
    """A picture that is opened when its rows are read, and stays open until nobody needs it."""

    def __init__(
        self, open: Callable[[], Any], take: Callable[[Any], Map], notes: Sequence[str]
    ) -> None:
        self._open, self._take, self.notes = open, take, tuple(notes)
        self._window: Window | None = None

    def __call__(self, tile: Tile) -> Map:
        if self._window is None:
            self._window = Window(self._open().rows)
        first = tile.maps.whole.first_row
        return self._take(self._window.rows(first, first + tile.maps.shape[0]))
