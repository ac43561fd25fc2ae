"""Files that appear under their final name whole, or not at all."""

import contextlib
import os
import re
import secrets
import time
from collections.abc import Iterator
from pathlib import Path

from cutis.textures.problem import problem, reason

_TEMPORARY = re.compile(r"^\..{1,40}\.[0-9a-f]{8}\.partial\.\w+$")
_FRESH = 1.0  # seconds in which a temporary file may not have its lock yet


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `path`; on success it takes the place of `path`.

    The temporary file exists (empty), keeps the extension, and is flushed to the disk before it is
    renamed. It is removed when the block raises, and `path` is then as it was. A link is followed:
    its target is replaced. The mode is that of the file replaced, else the umask decides.

        with replacing("report.json") as temporary:
            temporary.write_text(report)

    Raises CutisError where the folder is missing or unwritable or the disk is full; an OSError
    about any other file passes through.
    """
    path = Path(path)
    target = Path(os.path.realpath(path))
    name = f".{target.stem[:40]}.{secrets.token_hex(4)}.partial{target.suffix}"
    temporary = target.with_name(name)
    held = -1
    try:
        if target.is_dir():
            raise problem(path, "is a folder; give the name of a file to write")
        if not target.parent.is_dir():
            raise problem(path, f"the folder {target.parent} does not exist; create it first")
        held = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
        _locked(held)
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


def sweep(folder: Path) -> None:
    """Removes temporary files that processes left in `folder` when they were killed.

    Those of processes that live are locked and stay. Does nothing where files cannot be locked.
    """
    for path in folder.glob(".*.partial.*"):
        with contextlib.suppress(OSError):
            if _TEMPORARY.match(path.name) and time.time() - path.stat().st_mtime > _FRESH:
                descriptor = os.open(path, os.O_RDONLY)
                try:
                    if _locked(descriptor):
                        path.unlink()
                finally:
                    os.close(descriptor)


def _locked(descriptor: int) -> bool:
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
