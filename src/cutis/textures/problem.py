"""Complaints about a file, in one line."""

import os

from cutis.errors import CutisError, printable

_QUOTED = 200  # characters of a file's own text in a message


def problem(path: str | os.PathLike[str], what: str) -> CutisError:
    """The error "path: what", to be raised."""
    return CutisError(f"{os.fspath(path)}: {what}")


def shorten(text: str) -> str:
    """Text from a file as far as it fits into a message."""
    text = printable(text)
    return text if len(text) <= _QUOTED else f"{text[: _QUOTED - 1]}…"


def check_name(path: str | os.PathLike[str]) -> None:
    """Refuse a path that is not text (bytes that are no UTF-8), which OpenImageIO cannot take."""
    try:
        os.fspath(path).encode()
    except UnicodeEncodeError as cause:
        raise problem(path, "the name is not text (UTF-8); rename it") from cause


def reason(error: OSError) -> str:
    """What the system says, in lower case, without the file's name: "permission denied"."""
    text = error.strerror or str(error) or type(error).__name__
    return text[:1].lower() + text[1:]
