"""Blender as a process that can do little harm: a mesh from a stranger may crash it, or worse.

It has no network where the system allows it, no more memory than the machine, and its settings,
caches and temporary files are in a folder of its own.
"""

import contextlib
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from cutis.errors import CutisError, printable
from cutis.render.blender import quiet_environment

PATIENCE = 600.0
"""Seconds in which a Blender has to say something, such as that a sample is done."""
_LONGEST = 500  # characters of a message
_GRACE = 3.0  # seconds between asking a process to end and making it

_NAMESPACES = (("--net",), ("--map-current-user", "--net"))
"""Ways of `unshare` to leave the network: as root, and as anybody where users may."""


def started(command: list[str], folder: Path) -> subprocess.Popen[bytes]:
    """The process of a Blender's command line, whose output (both streams) is in a pipe.

    A terminal's Ctrl-C does not reach it: whoever starts it ends it.
    """
    process = subprocess.Popen(
        [*without_network(), *command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env=dict(quiet_environment(folder)),
        cwd=folder,
        start_new_session=True,
    )
    _limit_memory(process.pid)
    return process


def spoken(process: subprocess.Popen[bytes], patience: float = PATIENCE) -> Iterator[str]:
    """What the script in a Blender says, line by line, until it ends.

    Raises CutisError, and ends the process, where it tells no event (a line that begins with CUTIS)
    for `patience` seconds.
    """
    assert process.stdout is not None
    watch = _Watch(process, patience)
    try:
        for line in process.stdout:
            text = line.decode("utf-8", "replace").rstrip()
            if text.startswith("CUTIS "):
                watch.heard = time.monotonic()
            yield text
    finally:
        watch.done.set()
    if watch.over:
        raise CutisError(
            f"Blender was ended, as it got no further in {patience:.0f} s; try a simpler mesh, or "
            "fewer pixels"
        )


def end(process: subprocess.Popen[bytes]) -> None:
    """Ends a process and what it started, if it still runs."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    if process.stdout:
        process.stdout.close()


def words(message: object) -> str:
    """What a script's event says, as far as it fits into a message."""
    text = printable(str(message))
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


class _Watch:
    """Ends a process that says nothing for too long; `over` tells that it did."""

    def __init__(self, process: subprocess.Popen[bytes], patience: float) -> None:
        self.heard, self.over, self.done = time.monotonic(), False, threading.Event()
        self._process, self._patience = process, patience
        threading.Thread(target=self._look, daemon=True).start()

    def _look(self) -> None:
        while not self.done.wait(min(1.0, self._patience / 4)):
            if time.monotonic() - self.heard > self._patience:
                self.over = True
                self._process.kill()
                return


@lru_cache(maxsize=1)
def without_network() -> tuple[str, ...]:
    """What to put before a command so that it has no network; nothing where that is impossible."""
    tool = shutil.which("unshare") if sys.platform == "linux" else None
    if tool is None:
        return ()
    for way in _NAMESPACES if os.geteuid() == 0 else _NAMESPACES[1:]:
        command = (tool, *way, "--")
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            tried = subprocess.run(
                [*command, "true"], stdin=subprocess.DEVNULL, capture_output=True, timeout=10
            )
            if tried.returncode == 0:
                return command
    return ()


def _limit_memory(pid: int) -> None:
    """No more than the machine has, so that the system need not choose whom to end."""
    with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
        import resource

        most = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        _, hard = resource.prlimit(pid, resource.RLIMIT_DATA)
        if hard == resource.RLIM_INFINITY or hard > most:
            resource.prlimit(pid, resource.RLIMIT_DATA, (most, most))
