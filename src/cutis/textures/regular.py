"""Foreign files opened: regular ones only, and none longer than its kind ever is.

A name that somebody else chose may be that of a device or a pipe, which never end.
"""

import os
import stat
from typing import BinaryIO

from cutis.errors import CutisError
from cutis.textures.problem import problem, reason

Name = str | os.PathLike[str]
_OTHERS = (
    (stat.S_ISDIR, "is a folder; give a file"),
    (stat.S_ISCHR, "is a device, not a file; give a file"),
    (stat.S_ISBLK, "is a device, not a file; give a file"),
    (stat.S_ISFIFO, "is a pipe, not a file; write it into a file first"),
    (stat.S_ISSOCK, "is a socket, not a file; give a file"),
)
_NO_WAIT = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def open_regular(path: Name, longest: int | None = None) -> BinaryIO:
    """The file, open for reading bytes.

    Raises CutisError, one line that names it, where it is missing, may not be read, is a folder,
    device or pipe, or is longer than `longest` bytes.
    """
    try:
        _check(path, os.stat(path), longest)
        file = os.fdopen(os.open(path, os.O_RDONLY | _NO_WAIT), "rb")
    except FileNotFoundError as error:
        raise problem(path, "no such file; check the name") from error
    except OSError as error:
        raise problem(path, f"cannot be read: {reason(error)}; check its rights") from error
    except CutisError:
        raise
    except ValueError as error:  # a NUL in the name
        raise problem(path, f"is no name of a file ({error}); check the name") from error
    try:
        _check(path, os.fstat(file.fileno()), longest)  # it may be another by now
    except CutisError:
        file.close()
        raise
    return file


def read_regular(path: Name, longest: int) -> bytes:
    """All bytes of a file; see `open_regular`."""
    with open_regular(path, longest) as file:
        content = file.read(longest + 1)
    if len(content) > longest:  # it grew
        raise _too_long(path, longest)
    return content


def what_else(mode: int) -> str | None:
    """What a file of this mode is instead of a regular one, and what to do; None if it is one."""
    if stat.S_ISREG(mode):
        return None
    return next((what for is_kind, what in _OTHERS if is_kind(mode)), "is no file; give a file")


def state(path: Name) -> tuple[str, int, int, int, int]:
    """Changes when the file does: a key for what was found in it."""
    found = os.stat(path)
    return os.path.abspath(path), found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


def _check(path: Name, found: os.stat_result, longest: int | None) -> None:
    what = what_else(found.st_mode)
    if what is not None:
        raise problem(path, what)
    if longest is not None and found.st_size > longest:
        raise _too_long(path, longest)


def _too_long(path: Name, longest: int) -> CutisError:
    size = f"{longest >> 20} MiB" if longest >= 1 << 20 else f"{longest >> 10} KiB"
    return problem(path, f"is longer than {size}, more than such a file holds; check the name")
