"""Results that are there already: made of the same, of other contents, or in another way.

The report of a result says what it was made of (`MADE_FROM`): what was asked for, and a digest of
the content behind each. It is written last, and taken away before anything of a result is written
anew, so that where it is, all the rest is too.
"""

import contextlib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cutis.errors import CutisError
from cutis.jobs.job import Told, code_digest
from cutis.report import Report

MADE_FROM = "made_from"
FILES = "files"
CODE = "cutis"
"""The content that is the program's own code."""


@dataclass(frozen=True)
class Found:
    """What was found of a result: its report, or None; what differs from what is wanted.

    `asked` names what was asked for otherwise, `content` whose content has changed. Where
    `complete` is False, a file is missing, or nothing is there.
    """

    report: Report | None = None
    complete: bool = False
    asked: tuple[str, ...] = ()
    content: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        """Whether nothing is to be done."""
        return self.complete and not self.asked and not self.content


def made_from(wanted: Mapping[str, Told]) -> dict[str, Any]:
    """What a report says of what it was made from."""
    return {
        "asked": {name: one.asked for name, one in wanted.items()},
        "content": {
            **{name: one.content for name, one in wanted.items() if one.content},
            CODE: code_digest(),
        },
    }


def look(report: Path, wanted: Mapping[str, Told]) -> Found:
    """What is there of the result whose report this is, against what is wanted."""
    try:
        stored = json.loads(report.read_text("utf-8"))
        mark = stored[MADE_FROM]
        asked, content = dict(mark["asked"]), dict(mark["content"])
        files = [report.parent / str(name) for name in stored[FILES]]
        complete = all(file.is_file() for file in files)
        known = Report.from_dict({k: v for k, v in stored.items() if k not in (MADE_FROM, FILES)})
    except FileNotFoundError:
        return Found()
    except (CutisError, OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        # of an earlier version, or not of ours: how it was made nobody knows
        return Found(None, report.is_file(), asked=("what it was made with",))
    now = made_from(wanted)
    others = []
    for name, value in now["asked"].items():
        # a file of another name with the same content is no other request
        same = now["content"].get(name) == content.get(name, "") if content.get(name) else False
        if asked.get(name) != value and not same:
            others.append(name)
    changed = [
        name
        for name, value in now["content"].items()
        if name not in others and content.get(name) != value
    ]
    return Found(known, complete, tuple(others), tuple(changed))


@contextlib.contextmanager
def alone(result: Path) -> Iterator[None]:
    """Holds the name `result` while its files are written: a second writer is refused in one line.

    The lock goes with the process that holds it, however that ends.
    """
    lock = result.with_name(f".{result.name}.lock")
    try:
        import fcntl
    except ModuleNotFoundError:  # Windows: an open file cannot be removed by another
        fcntl = None  # type: ignore[assignment]
    while True:
        try:
            descriptor = os.open(lock, os.O_CREAT | os.O_RDWR, 0o666)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise CutisError(f"{result.parent}: cannot be written to ({reason})") from error
        try:
            if fcntl is not None:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            else:
                import msvcrt

                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError as error:
            os.close(descriptor)
            if error.errno in (11, 13, 35, 36):
                raise CutisError(
                    f"{result}: another run is writing these results; wait for it, or give "
                    "another folder"
                ) from error
            raise
        # whoever held it before has removed the file it was on: take a new one
        with contextlib.suppress(FileNotFoundError):
            if os.fstat(descriptor).st_ino == lock.stat().st_ino or os.name == "nt":
                break
        os.close(descriptor)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            if os.name != "nt":
                lock.unlink()
        os.close(descriptor)
        with contextlib.suppress(OSError):
            if os.name == "nt":
                lock.unlink()
