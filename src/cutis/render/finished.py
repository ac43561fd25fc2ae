"""Which pictures of a sequence are done, so that a run that was stopped goes on.

Beside the pictures lies STEM.frames.json: for each finished picture the digest of all that it
depends on. A picture counts as done when it is there under the digest that it would get now.
"""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cutis.textures import replacing


def digest(recipe: Mapping[str, Any]) -> str:
    """SHA-256 of all that a picture depends on, as JSON holds it."""
    text = json.dumps(recipe, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


class Finished:
    """The finished pictures that `path` (STEM.frames.json) lists; an unreadable list is empty."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._digests: dict[str, str] = {}
        try:
            stored = json.loads(path.read_text("utf-8"))
            self._digests = {str(name): str(value) for name, value in stored.items()}
        except (OSError, ValueError, AttributeError):
            pass

    def has(self, picture: Path, recipe: str) -> bool:
        """Whether `picture` is there and was made by this recipe."""
        return picture.is_file() and self._digests.get(picture.name) == recipe

    def drop(self, picture: Path) -> None:
        """Forgets `picture`, before it is written anew."""
        if self._digests.pop(picture.name, None) is not None:
            self._write()

    def put(self, picture: Path, recipe: str) -> None:
        """Notes that `picture` has been written."""
        self._digests[picture.name] = recipe
        self._write()

    def _write(self) -> None:
        with replacing(self.path) as partial:
            partial.write_text(json.dumps(self._digests, indent=1) + "\n", encoding="utf-8")
