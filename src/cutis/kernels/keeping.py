"""Where machine code is kept between runs.

A folder is named by a digest of every source that machine code is made of and of the versions of
what makes it; a file in it by the function, the types that it was compiled for and the processor.
So nothing stale is ever found: other sources look in another folder. Every file begins with a
digest of its content, and one that was cut off or changed counts as absent. What cannot be kept is
compiled again in the next run, which is said once.

Files are machine code, so a folder is believed only if this user or root owns it and nobody else
may write to it. It is in NUMBA_CACHE_DIR if that is set, in the user's cache, or beside temporary
files, the first of them that can be written.
"""

import ast
import contextlib
import hashlib
import logging
import os
import pickle
import stat
import sys
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.misc.appdirs import AppDirs

PACKAGE, MAKER = "cutis", "cutis.kernels.compiling"
"""What modules import that make machine code."""
PREFIX, ENDING = "code-", ".code"
"""Of the names of our folders and files: nothing else is ever removed."""
GENERATIONS = 16
"""Folders that stay when a new one is made, the latest used."""
DIGEST = hashlib.sha256().digest_size
DAY = 86400.0


class KeptCode(_Cache):
    """The machine code of one function, in the terms of Numba."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    @property
    def cache_path(self) -> str | None:
        """Where it is looked for first."""
        return next((str(folder) for folder in folders()), None)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept for these types, or None."""
        target_context.refresh()
        payload = read(self._name(sig, target_context.codegen()))
        if payload is None:
            return None
        try:
            return CompileResult._rebuild(target_context, *pickle.loads(payload))
        except Exception:  # whatever it is, a new one is as good
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keeps it, unless it is of a module that the name of the folder does not speak for."""
        if self._function.__module__ in sources() and not data.library.has_dynamic_globals:
            write(self._name(sig, data.codegen), dumps(data._reduce()))

    def _name(self, sig: Any, codegen: Any) -> str:
        how = repr((sig, codegen.magic_tuple())).encode()
        where = f"{self._function.__module__}.{self._function.__qualname__}"
        return f"{where}-{hashlib.sha256(how).hexdigest()[:20]}{ENDING}"

    def enable(self) -> None:
        """It always is."""

    def disable(self) -> None:
        """It never is."""

    def flush(self) -> None:
        """Nothing waits to be written."""


def read(name: str) -> bytes | None:
    """What was written under a name, if it is whole."""
    for folder in folders():
        with contextlib.suppress(OSError):
            if not _believed(folder):
                continue
            content = (folder / name).read_bytes()
            if hashlib.sha256(content[DIGEST:]).digest() == content[:DIGEST]:
                _used(folder)
                return content[DIGEST:]
    return None


def write(name: str, payload: bytes) -> None:
    """Keeps it in the first folder that takes it."""
    for folder in folders():
        with contextlib.suppress(OSError):
            if not folder.is_dir():
                _make(folder)
            if not _believed(folder):
                continue
            partial = folder / f".{uuid.uuid4().hex}{ENDING}"
            try:
                partial.write_bytes(hashlib.sha256(payload).digest() + payload)
                partial.replace(folder / name)
            finally:
                partial.unlink(missing_ok=True)
            return
    _say_once()


@cache
def folders() -> tuple[Path, ...]:
    """Where machine code of these sources may be, the best place first."""
    if not sources():  # an application that holds none
        return ()
    versions = (sys.version, numba.__version__, llvmlite.__version__)
    digest = hashlib.sha256(repr((versions, sorted(sources().items()))).encode())
    user = f"-{os.getuid()}" if hasattr(os, "getuid") else ""
    places = [
        os.path.join(os.environ.get("NUMBA_CACHE_DIR") or "", PACKAGE),
        AppDirs(PACKAGE, appauthor=False).user_cache_dir,
        os.path.join(tempfile.gettempdir(), PACKAGE + user),
    ]
    name = PREFIX + digest.hexdigest()[:20]
    return tuple(Path(place) / name for place in places if os.path.isabs(place))


@cache
def sources() -> dict[str, bytes]:
    """Text of the modules that machine code is made of, by their names.

    They are those that import MAKER, and all of the package that those import.
    """
    texts = dict(_modules(resources.files(PACKAGE), PACKAGE))
    mark = f"from {MAKER} import".encode()
    waiting = [name for name, text in texts.items() if mark in text]
    found: dict[str, bytes] = {}
    while waiting:
        name = waiting.pop()
        if name in texts and name not in found:
            found[name] = texts[name]
            waiting += _imports(texts[name])
    return found


def _modules(folder: Traversable, name: str) -> Iterator[tuple[str, bytes]]:
    for entry in folder.iterdir():
        if entry.is_dir() and entry.name != "__pycache__":
            yield from _modules(entry, f"{name}.{entry.name}")
        elif entry.name.endswith(".py"):
            stem = entry.name.removesuffix(".py")
            yield (name if stem == "__init__" else f"{name}.{stem}"), entry.read_bytes()


def _imports(text: bytes) -> list[str]:
    """Names that may be modules in the imports at the top of a module."""
    found = []
    for node in ast.parse(text).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            found += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
    return found


def _believed(folder: Path) -> bool:
    """Whether only this user or root can have written to the folder and that around it."""
    if not hasattr(os, "getuid"):
        return folder.is_dir()
    for place in (folder, folder.parent):
        found = os.lstat(place)
        if found.st_uid not in (0, os.getuid()) or not stat.S_ISDIR(found.st_mode):
            return False
        if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            return False
    return True


def _make(folder: Path) -> None:
    """Makes the folder, and room for it: of the others of this kind, the least used go."""
    for place in (folder.parent, folder):
        place.mkdir(mode=0o755, parents=True, exist_ok=True)
    others = [place for place in folder.parent.glob(f"{PREFIX}*") if place != folder]
    others.sort(key=lambda place: place.stat().st_mtime)
    for old in others[: 1 - GENERATIONS]:
        with contextlib.suppress(OSError):
            for file in (*old.glob(f"*{ENDING}"), *old.glob(f".*{ENDING}")):
                file.unlink()
            old.rmdir()


@cache
def _used(folder: Path) -> None:
    """Marks the folder, once a day, as one that is needed."""
    with contextlib.suppress(OSError):
        if time.time() - folder.stat().st_mtime > DAY:
            os.utime(folder)


@cache
def _say_once() -> None:
    tried = " or ".join(str(folder.parent) for folder in folders())
    logging.getLogger(PACKAGE).warning(
        "cutis: compiled code cannot be kept in %s, so every run compiles anew; "
        "name a folder that can be written in NUMBA_CACHE_DIR",
        tried,
    )
