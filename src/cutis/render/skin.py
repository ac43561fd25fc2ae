"""The skin that a picture shows: diffuse albedo of maps with edits, or of a texture, in bands.

Pictures need the albedo itself: the calibration that the estimate found is applied, so that a
capture's cast and exposure do not end up in the light. Of maps whose capture is there, what the
model does not explain (beard, eyes, fine detail) rides along, as it does in edited textures.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import Space
from cutis.errors import CutisError
from cutis.maps import Change, MapsFile, SkinMaps, default_tissue, find_source, open_source
from cutis.optics import Tissue
from cutis.textures import Orientation, TextureFile
from cutis.textures.closing import Closing

_TURNED = tuple("2345678")  # numbers of orientation tags
MAPS = ".skin.exr"
"""How names of files of maps end."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Albedo (h, W, 3) in [0, 1], linear sRGB, of some rows, and their maps if there are any."""

    albedo: NDArray[np.float32]
    maps: SkinMaps | None


class Skin(Closing):
    """Diffuse albedo of a file, some rows at a time.

    `path` is NAME.skin.exr, or an albedo texture, whose colours are taken as they are. `source` is
    the capture of maps, where it is not what their header names; `model_only` leaves it out.
    `shape` is (H, W) of the picture that UVs from 0 to 1 cover, `notes` say what was chosen in the
    files. `orientation` "ignore" keeps a texture in the order it is stored in. Close it, or use it
    in a with block. Raises CutisError for files that cannot be read.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        source: Path | None = None,
        model_only: bool = False,
        colorspace: str | Space = "auto",
        orientation: Orientation = "auto",
    ) -> None:
        self.path = Path(path)
        self.maps: MapsFile | None = None
        self.capture: TextureFile | None = None
        self.notes: list[str] = []
        try:
            if self.path.name.endswith(MAPS):
                self.maps = MapsFile(self.path, shown=True)
                self.shape = self.maps.shape
                self.notes += self.maps.notes
                number = self.maps.provenance.get("source_orientation", "")
                if number in _TURNED:
                    self.notes.append(
                        f"the capture was turned as its orientation tag ({number}) says; if the "
                        "UVs know no tag, estimate with --orientation ignore"
                    )
                if not model_only:
                    self._find_capture(source)
            else:
                self.capture = TextureFile(self.path, colorspace, None, orientation, shown=True)
                self.shape = self.capture.shape
                self.notes += self.capture.notes
        except BaseException:
            self.close()
            raise

    def _find_capture(self, given: Path | None) -> None:
        assert self.maps is not None
        notes = self.maps.provenance
        if given is None and "source" not in notes:
            return
        path = find_source(notes, self.path, given)
        self.capture = open_source(notes, path, shown=True)
        if self.capture.shape != self.shape:
            raise CutisError(f"{path}: the texture is {self.capture.shape}, the maps {self.shape}")

    @property
    def tissue(self) -> Tissue:
        """The tissue of the maps' model; of a texture, that of the default model."""
        return default_tissue() if self.maps is None else self.maps.made_by.load().tissue

    @property
    def stem(self) -> str:
        """The file's name without what it ends in."""
        name = self.path.name
        return name.removesuffix(MAPS) if name.endswith(MAPS) else self.path.stem

    def origins(self) -> list[Path]:
        """The files that the skin was made from, there or not: whom to credit."""
        found = [self.path, *([] if self.capture is None else [self.capture.path])]
        if self.maps is not None and "source" in self.maps.provenance:
            source = Path(self.maps.provenance["source"])
            found += [self.path.parent / source, self.path.parent / source.name]
        return found

    def close(self) -> None:
        """Lets go of the files."""
        for file in (self.maps, self.capture):
            if file is not None:
                file.close()

    def bands(self) -> Iterator[slice]:
        """Slices of rows that cover the image."""
        opened = self.maps or self.capture
        assert opened is not None
        return opened.bands()

    def rows(self, rows: slice, changes: Sequence[Change] = ()) -> Rows:
        """Some rows, changed; CutisError for edits of a texture, which has no maps."""
        if self.maps is None:
            if changes:
                raise self.no_maps()
            assert self.capture is not None
            return Rows(_clipped(self.capture.rows(rows).linear()), None)
        skin = self.maps.edited(rows, changes, trust=False)
        if self.capture is not None:
            skin = skin.with_capture(self.capture.rows(rows).linear())
        return Rows(_clipped(skin.calibration.apply(skin.albedo())), skin)

    def no_maps(self) -> CutisError:
        """What to raise when a texture is to be edited."""
        return CutisError(
            f"{self.path.name} is a texture; edits need its maps (NAME{MAPS}), which cutis "
            "estimate makes"
        )


def _clipped(colours: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.clip(colours, 0, 1)
