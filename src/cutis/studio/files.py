"""The files that a page may open: those that were named, and those of a folder, by number."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from cutis.errors import CutisError, printable
from cutis.studio.opening import Opening
from cutis.studio.projects import ENDING
from cutis.textures.headers import EXTENSIONS

MOST = 2000
"""Files of a folder that are listed."""
NOT_CAPTURES = (".model.exr",)


class Files:
    """A list that grows and never changes its numbers; paths do not leave it."""

    def __init__(self, named: Sequence[Opening], folder: Path, like: Opening) -> None:
        """`like` says how captures of the folder are to be opened."""
        self._all = list(named)
        self._folder, self._like = folder, like

    def list(self) -> list[dict[str, object]]:
        """Numbers and names, the named ones first, then what is in the folder now."""
        known = {one.path.resolve() for one in self._all}
        for path in _in_folder(self._folder):
            if path.resolve() not in known:
                self._all.append(replace(self._like, path=path, mask=None))
        return [
            {"file": i, "name": printable(one.path.name)}
            for i, one in enumerate(self._all)
            if one.path.is_file()
        ]

    def opening(self, number: int) -> Opening:
        """What a number stands for; CutisError where there is none."""
        if not 0 <= number < len(self._all):
            raise CutisError("there is no such file in the list; ask for the list again")
        return self._all[number]


def _in_folder(folder: Path) -> list[Path]:
    try:
        found = sorted(path for path in folder.iterdir() if path.is_file())
    except OSError:
        return []
    pictures = [
        path for path in found
        if path.suffix.lower() in EXTENSIONS
        and not path.name.startswith(".")
        and not path.name.endswith((*NOT_CAPTURES, ENDING))
    ]  # fmt: skip
    return pictures[:MOST]
