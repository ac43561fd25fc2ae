"""Files that appear under their final name whole, or not at all."""

import contextlib
import os
import re
import secrets
import time
from collections.abc import Iterator
from pathlib import Path

from cutis.errors import CutisError
from cutis.textures.problem import problem, reason
from cutis.textures.regular import Name, what_else

_TEMPORARY = re.compile(r"^\..{1,40}\.[0-9a-f]{8}\.partial(\.\w+)?$")
_FRESH = 1.0  # seconds in which a temporary file may not have its lock yet
_LONGEST_NAME, _LONGEST_PATH = 255, 4096  # bytes, where the system does not say
_MARKS = len("..01234567.partial")
_swept: set[Path] = set()
"""Folders in which this process has looked for what others left."""


def check_writable(path: Name) -> None:
    """Refuse a name that cannot be written, before any work.

    Raises CutisError for a name or path that is longer than the system takes, a folder, and what is
    no regular file (a device, a pipe, or a link to one), which would be replaced by one. Its folder
    may be made later.
    """
    _target(Path(path), made=False)


@contextlib.contextmanager
def replacing(path: Name) -> Iterator[Path]:
    """Yield a temporary path beside `path`; on success it takes the place of `path`.

    The temporary file exists (empty), keeps the extension, and is flushed to the disk before it is
    renamed. It is removed when the block raises, and `path` is then as it was. A link is followed:
    its target is replaced. The mode is that of the file replaced, else the umask decides. What
    killed processes left in the folder goes first (`sweep`).

        with replacing("report.json") as temporary:
            temporary.write_text(report)

    Raises CutisError as `check_writable` does, and where the folder is missing or unwritable or the
    disk is full; an OSError about any other file passes through.
    """
    path = Path(path)
    target, temporary = _target(path)
    if target.parent not in _swept:
        _swept.add(target.parent)
        sweep(target.parent)
    held = -1
    try:
        held = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
        locked(held)
        with contextlib.suppress(FileNotFoundError):
            os.chmod(temporary, target.stat().st_mode & 0o777)
        yield temporary
        os.fsync(held)
        os.replace(temporary, target)
    except OSError as error:
        about = None if error.filename is None else Path(os.fsdecode(error.filename))
        if about not in (None, temporary, target):
            raise
        what = f"cannot be written ({reason(error)}); check the folder's rights and free space"
        raise problem(path, what) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        if held >= 0:
            os.close(held)


def _target(path: Path, made: bool = True) -> tuple[Path, Path]:
    """The file that `path` means, links followed, and a temporary name beside it."""
    try:
        target = Path(os.path.realpath(path))
        name = f".{_stem(target)}.{secrets.token_hex(4)}.partial{target.suffix}"
        temporary = target.with_name(name)
        if made and not target.parent.is_dir():
            raise problem(path, f"the folder {target.parent} does not exist; create it first")
        longest_name = _limit(target.parent, "PC_NAME_MAX", _LONGEST_NAME)
        longest_path = _limit(target.parent, "PC_PATH_MAX", _LONGEST_PATH)
        for one in (target, temporary):
            if len(os.fsencode(one.name)) > longest_name:
                what = f"its name is longer than {longest_name} bytes; choose a shorter one"
                raise problem(path, f"cannot be written: {what}")
            if len(os.fsencode(one)) >= longest_path:
                what = f"its path is longer than {longest_path} bytes; choose a shorter one"
                raise problem(path, f"cannot be written: {what}")
        if target.is_dir():
            raise problem(path, "is a folder; give the name of a file to write")
        other = what_else(target.stat().st_mode) if target.exists() else None
        if other is not None:
            raise problem(path, f"{other.partition(';')[0]}; give the name of a file to write")
    except OSError as error:
        raise problem(path, f"cannot be written ({reason(error)}); check the name") from error
    except CutisError:
        raise
    except ValueError as error:  # a NUL in the name
        raise problem(path, f"cannot be written ({error}); check the name") from error
    return target, temporary


def _stem(target: Path) -> str:
    """The start of the name, so short that a temporary name is no longer than names may be."""
    room = _LONGEST_NAME - _MARKS - len(os.fsencode(target.suffix))
    stem = target.stem[:40]
    while len(stem) > 1 and len(os.fsencode(stem)) > room:
        stem = stem[:-1]
    return stem


def _limit(folder: Path, name: str, otherwise: int) -> int:
    try:
        return os.pathconf(folder, name)
    except (AttributeError, OSError, ValueError):
        return otherwise


def sweep(folder: Path) -> None:
    """Removes temporary files that processes left in `folder` when they were killed.

    Only what bears the mark of `replacing`; those of processes that live are locked and stay. Does
    nothing where files cannot be locked.
    """
    try:
        with os.scandir(folder) as found:
            left = [Path(entry.path) for entry in found if _TEMPORARY.match(entry.name)]
    except OSError:
        return
    for path in left:
        with contextlib.suppress(OSError):
            status = path.lstat()
            if what_else(status.st_mode) is None and time.time() - status.st_mtime > _FRESH:
                descriptor = os.open(path, os.O_RDONLY)
                try:
                    if locked(descriptor):
                        path.unlink()
                finally:
                    os.close(descriptor)


def locked(descriptor: int) -> bool:
    """Whether a file is now locked by us; it stays so until its descriptor is closed."""
    try:
        import fcntl
    except ModuleNotFoundError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
