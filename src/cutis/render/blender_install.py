"""Blender as a Python module, installed into an environment of its own.

`bpy` wants another NumPy than cutis and is under the GPL: it never shares cutis's environment and
is never imported by it. Versions are in `cutis/data/blender/constraints.txt`.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import resources
from pathlib import Path

from cutis.errors import CutisError

PYTHONS = ("3.11", "3.13")
"""Pythons that a Blender exists for as a module; the first one found is taken."""
_STAMP = "cutis-blender.txt"  # what was installed; written last


def own_folder() -> Path:
    """Where the environment is: beside cutis's own if that is a virtual one, else the user's."""
    if sys.prefix != sys.base_prefix:
        return Path(sys.prefix) / "cutis-blender"
    data = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_DATA_HOME")
    return (Path(data) if data else Path.home() / ".local" / "share") / "cutis-blender"


def own_python(folder: Path | None = None) -> Path | None:
    """The Python of a finished environment, or None."""
    folder = folder or own_folder()
    python = _python_of(folder)
    return python if (folder / _STAMP).is_file() and python.is_file() else None


def install(
    folder: Path | None = None, say: Callable[[str], None] | None = None, python: str | None = None
) -> Path:
    """Installs Blender where `find_blender` looks for it, and returns its Python.

    folder: instead of `own_folder()`. say: told each step. python: the Python to make the
    environment with, by default the first of `PYTHONS` that is at hand. Where the environment is
    finished and current, nothing is done; an unfinished one is made anew.

    Raises CutisError where there is no such Python, or the packages cannot be had.
    """
    folder = folder or own_folder()
    say = say or (lambda step: None)
    wanted = resources.files("cutis.data").joinpath("blender", "constraints.txt").read_text("utf-8")
    stamp = folder / _STAMP
    done = own_python(folder)
    if done is not None and stamp.read_text("utf-8") == wanted:
        return done
    base = python or _find_python()
    try:
        shutil.rmtree(folder, ignore_errors=True)
        folder.parent.mkdir(parents=True, exist_ok=True)
        say("making an environment")
        _call([base, "-m", "venv", str(folder)], "the environment cannot be made")
        own = _python_of(folder)
        say("installing Blender (about 400 MB)")
        with tempfile.TemporaryDirectory() as name:
            file = Path(name) / "constraints.txt"
            file.write_text(wanted, "utf-8")
            pip = [*("-m", "pip", "install", "--disable-pip-version-check", "--quiet")]
            _call([str(own), *pip, "--requirement", str(file)], "Blender cannot be installed")
        say("starting it once")
        _call([str(own), "-I", "-c", "import bpy"], "Blender was installed but does not start")
        # Its presence says that the rest is there: written elsewhere, then renamed.
        written = folder / f"{_STAMP}.partial"
        written.write_text(wanted, "utf-8")
        written.replace(stamp)
    except OSError as error:
        raise CutisError(
            f"{folder}: cannot be written ({error.strerror}); check rights and space"
        ) from error
    finally:
        if not stamp.is_file():
            shutil.rmtree(folder, ignore_errors=True)
    return own


def _python_of(folder: Path) -> Path:
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def _find_python() -> str:
    """A Python that a Blender exists for: this one, or one on PATH."""
    for version in PYTHONS:
        names = (sys.executable, f"python{version}", "python3", "python")
        candidates = [found for name in names if (found := shutil.which(name))]
        for candidate in candidates:
            if _version_of(candidate) == version:
                return candidate
    raise CutisError(
        f"Blender as a module needs Python {' or '.join(PYTHONS)}, and there is none on PATH; "
        "install one, or name a Blender of your own with --blender PATH"
    )


def _version_of(python: str) -> str:
    ask = "import sys, venv, ensurepip; print('%d.%d' % sys.version_info[:2])"
    try:
        answer = subprocess.run(
            [python, "-I", "-c", ask], capture_output=True, text=True, timeout=60
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return answer.stdout.strip()


def _call(command: list[str], failure: str) -> None:
    """Runs a command that ends with this process; its last line becomes part of the error."""
    kept = {k: v for k, v in os.environ.items() if k not in ("PYTHONHOME", "PYTHONPATH")}
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, env=kept
        )
        try:
            status = process.wait()
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
        output.seek(0)
        lines = output.read().decode("utf-8", "replace").strip().splitlines()
    if status:
        raise CutisError(f"{failure}: {lines[-1] if lines else f'status {status}'}")


if __name__ == "__main__":
    try:
        print(install(say=lambda step: print(step, flush=True)))
    except CutisError as error:
        sys.exit(f"cutis: {error}")
