"""Files that appear under their final name whole, or not at all."""

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path

from cutis.textures.problem import problem, reason


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
    name = f".{target.stem[:40]}.{secrets.token_hex(4)}{target.suffix}"
    temporary = target.with_name(name)
    try:
        if target.is_dir():
            raise problem(path, "is a folder; give the name of a file to write")
        if not target.parent.is_dir():
            raise problem(path, f"the folder {target.parent} does not exist; create it first")
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        with contextlib.suppress(FileNotFoundError):
            os.chmod(temporary, target.stat().st_mode & 0o777)
        yield temporary
        with open(temporary, "rb+") as file:
            os.fsync(file.fileno())
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
