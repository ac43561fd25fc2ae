"""Names of results: checked before any work is done."""

import contextlib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from cutis.errors import CutisError
from cutis.textures import check_writable


def same_file(one: Path, other: Path) -> bool:
    """Whether two names are of one file, also through links."""
    return one.resolve() == other.resolve() or (
        one.exists() and other.exists() and one.samefile(other)
    )


def check_outputs(outputs: Iterable[Path | None], inputs: Mapping[str, Path | None]) -> None:
    """CutisError where an output is an input, another output, or no file that can be written.

    `inputs` are what is read, by what it is called.
    """
    written: list[Path] = []
    for output in outputs:
        if output is None:
            continue
        check_writable(output)
        for what, path in inputs.items():
            if path is not None and same_file(output, path):
                raise CutisError(f"{output} is {what} itself; write to another name")
        if any(same_file(output, path) for path in written):
            raise CutisError(f"{output} would be written twice; give two names")
        written.append(output)


def make_folder(folder: Path) -> None:
    """Makes the folder of the results; CutisError where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or str(error)
        raise CutisError(f"{folder}: cannot make this folder ({reason.lower()})") from error


@contextlib.contextmanager
def made_folder(folder: Path) -> Iterator[None]:
    """The same; folders that it made go again if the block fails and leaves them empty."""
    new = [one for one in (folder, *folder.parents) if not one.exists()]
    make_folder(folder)
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError):
            for one in new:
                one.rmdir()
        raise
