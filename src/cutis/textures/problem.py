"""Complaints about a file, in one line."""

import os

from cutis.errors import CutisError

LARGEST = 32768  # texels along a side


def problem(path: str | os.PathLike[str], what: str) -> CutisError:
    """The error "path: what", on one line whatever line breaks either holds, to be raised."""
    line = " ".join(f"{os.fspath(path)}: {what}".splitlines())
    return CutisError(line.encode("utf-8", "backslashreplace").decode())  # so that it prints


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


def check_size(path: str | os.PathLike[str], width: int, height: int) -> None:
    """Refuse an image without texels or with a side longer than `LARGEST` texels."""
    if width < 1 or height < 1:
        raise problem(path, f"has no texels ({width} × {height}); export it again")
    if max(width, height) > LARGEST:
        what = f"claims {width} × {height} texels, the limit is {LARGEST} × {LARGEST}"
        raise problem(path, f"{what}; split it into tiles, or export it again if it is damaged")
