"""Where the files that a look names lie: in its own folder, unless somebody allowed others."""

from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from cutis.errors import CutisError
from cutis.textures.problem import shorten
from cutis.textures.udim import TOKEN, tile_of


@dataclass(frozen=True)
class Folder:
    """The folder that names in a look are seen from, and whether they may lead out of it.

    A look that was made in Python, and read from no file, has the current one.
    """

    path: Path | None = None
    outside: bool = True

    def place(self, name: str) -> Path:
        """Where a file that a look calls `name` would be; CutisError where it may not be there."""
        base = Path() if self.path is None else self.path
        path = base / PurePosixPath(name)
        try:
            inside = path.resolve().is_relative_to(base.resolve())
        except (OSError, ValueError) as error:
            raise CutisError(f"{shorten(name)!r} is no name of a file; check it") from error
        if not inside and not self.outside:
            raise CutisError(
                f"{shorten(name)!r} is outside the folder of the look; put it there, or allow it "
                "with --allow-outside"
            )
        return path

    def find(self, name: str, tile: int | None = None) -> Path:
        """The file, or that of a tile of NAME.<UDIM>.EXT; CutisError where it is not there too."""
        path = self.place(name)
        if tile is not None:
            path = tile_of(path, tile)
        if not path.is_file() and TOKEN not in path.name:
            raise CutisError(f"there is no file {path}; check the name")
        return path
