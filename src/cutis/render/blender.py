"""Blender: which one, and pictures rendered by it in a process of its own.

Looked for in this order: the path given, `$BLENDER`, the environment that `cutis render --install`
made, `blender` on PATH. The environment comes before PATH because its version is known to work,
and a system's own Blender is often too old; who wants another one names it. A path may be a
Blender, a folder that holds one, or a Python that has the module `bpy`.
"""

import os
import re
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cutis.errors import CutisError
from cutis.render.blender_install import own_python

OLDEST = (4, 2)
"""Blender's scripts of before differ too much."""
INSTALL = "cutis render --install"
_PATIENCE = 120  # seconds for a Blender to tell its version; a first start on a slow disk is long
_ASK = "import bpy; print('Blender', bpy.app.version_string)"


@dataclass(frozen=True)
class Blender:
    """A Blender that can be run.

    executable: the program; module: whether it is a Python that has `bpy`; version: three numbers.
    """

    executable: Path
    module: bool
    version: tuple[int, int, int]

    def command(self, script: Path, *arguments: str) -> list[str]:
        """The command line that runs a script with arguments, without the user's settings."""
        if self.module:
            return [str(self.executable), "-I", str(script), *arguments]
        return [
            *(str(self.executable), "--background", "--factory-startup", "-noaudio"),
            *("--offline-mode", "--python-exit-code", "1", "--python", str(script), "--"),
            *arguments,
        ]


def find_blender(path: str | os.PathLike[str] | None = None) -> Blender:
    """The Blender to use, checked to start and to be of a version that works.

    Raises CutisError where there is none, or it does not start, or is older than 4.2.
    """
    for given, origin in ((path, ""), (os.environ.get("BLENDER"), "$BLENDER: ")):
        if given:
            return _checked(_executable(Path(given), origin), origin)
    own = own_python()
    if own is not None:
        return _checked(own, "")
    found = shutil.which("blender")
    if found is None:
        raise CutisError(
            f"there is no Blender; install one with `{INSTALL}`, or name yours with --blender PATH"
        )
    return _checked(Path(found), "")


def quiet_environment(folder: Path) -> Mapping[str, str]:
    """The environment for a Blender: settings, crash reports and caches go to `folder`.

    Variables that would change what it computes are left out (`OCIO` swaps its colour spaces).
    """
    kept = {
        name: value
        for name, value in os.environ.items()
        if name != "OCIO" and not name.startswith(("BLENDER", "PYTHON", "CYCLES"))
    }
    return kept | {"BLENDER_USER_RESOURCES": str(folder), "TMPDIR": str(folder)}


def _executable(path: Path, origin: str) -> Path:
    if path.is_dir():
        inside = ("blender", "blender.exe", "Contents/MacOS/Blender", "bin/python")
        found = next((path / name for name in inside if (path / name).is_file()), None)
        if found is None:
            raise CutisError(f"{origin}{path}: there is no Blender in this folder")
        return found
    if path.is_file():
        return path
    found_on_path = shutil.which(str(path)) if path.name == str(path) else None
    if found_on_path is None:
        raise CutisError(f"{origin}{path}: there is no such Blender; `{INSTALL}` installs one")
    return Path(found_on_path)


def _checked(executable: Path, origin: str) -> Blender:
    executable = Path(os.path.abspath(executable))  # not resolved: a venv's python is a link
    module = re.match(r"(python|pypy)", executable.name.lower()) is not None
    asked = ["-I", "-c", _ASK] if module else ["--background", "--factory-startup", "--version"]
    try:
        answer = subprocess.run(
            [str(executable), *asked],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PATIENCE,
            env=quiet_environment(Path(os.devnull)),
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        what = "does not answer" if isinstance(error, subprocess.TimeoutExpired) else "cannot run"
        raise CutisError(f"{origin}{executable}: {what}; `{INSTALL}` installs a Blender") from error
    text = answer.stdout.decode("utf-8", "replace")
    found = re.search(r"^Blender (\d+)\.(\d+)(?:\.(\d+))?", text, re.MULTILINE)
    if found is None:
        lacks = "is a Python without the module bpy" if module else "is not a Blender"
        raise CutisError(f"{origin}{executable}: {lacks}; `{INSTALL}` installs one")
    version = (int(found[1]), int(found[2]), int(found[3] or 0))
    if version[:2] < OLDEST:
        told = ".".join(map(str, version))
        raise CutisError(
            f"{origin}{executable}: Blender {told} is too old, 4.2 is the first that works; "
            f"`{INSTALL}` installs one that does"
        )
    return Blender(executable, module, version)
