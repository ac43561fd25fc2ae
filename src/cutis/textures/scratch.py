"""Folders for temporary files, which a later run removes where this one cannot: it was killed."""

import contextlib
import os
import re
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from cutis.errors import CutisError
from cutis.textures.atomic import locked
from cutis.textures.problem import reason

_NAME = re.compile(r"^cutis-[0-9a-f]{8}$")
_MARK = "made-by-cutis"
"""A file in each folder, locked for as long as its maker lives."""
_FRESH = 60.0  # seconds in which a folder may not have its mark yet


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """A new folder where the system keeps temporary files, gone with all in it after the block.

    What processes that were killed left there goes first. Raises CutisError where no folder can be
    made.
    """
    try:
        place = Path(tempfile.gettempdir())
        sweep_scratch(place)
        folder = place / f"cutis-{secrets.token_hex(4)}"
        folder.mkdir(mode=0o700)
        held = os.open(folder / _MARK, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
    except OSError as error:
        what = f"there is no folder for temporary files ({reason(error)})"
        raise CutisError(f"{what}; name one that can be written in TMPDIR") from error
    locked(held)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(held)


def sweep_scratch(place: Path) -> None:
    """Removes folders of `scratch_folder` in `place` whose makers live no more.

    Only this user's, with the mark in them; nothing where files cannot be locked.
    """
    try:
        with os.scandir(place) as found:
            left = [Path(entry.path) for entry in found if _NAME.match(entry.name)]
    except OSError:
        return
    for folder in left:
        with contextlib.suppress(OSError):
            _remove(folder)


def _remove(folder: Path) -> None:
    status = folder.lstat()
    ours = not hasattr(os, "getuid") or status.st_uid == os.getuid()
    if not (ours and stat.S_ISDIR(status.st_mode)):
        return
    try:
        held = os.open(folder / _MARK, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0))
    except FileNotFoundError:
        if time.time() - status.st_mtime > _FRESH:
            folder.rmdir()  # its maker was killed before the first file; fails if there are any
        return
    try:
        if locked(held):
            shutil.rmtree(folder, ignore_errors=True)
    finally:
        os.close(held)
