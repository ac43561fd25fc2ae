"""Blender as a Python module, in an environment of its own.

`bpy` pins other versions of NumPy than cutis may have and is under the GPL, so it never shares
cutis's environment and is never imported by it. Versions: `cutis/data/blender/constraints.txt`.
"""

import os
import shutil
import subprocess
import sys
from importlib import resources
from pathlib import Path

from cutis.errors import CutisError

PYTHONS = {"3.11": ("bpy==5.0.1", "numpy==1.26.4"), "3.13": ("bpy==5.2.3",)}
"""What is installed for the Pythons that Blender exists for."""
_STAMP = "cutis-blender"


def own_folder() -> Path:
    """Where the environment is: beside cutis's own if that is a virtual one, else the user's."""
    if sys.prefix != sys.base_prefix:
        return Path(sys.prefix) / "cutis-blender"
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(os.environ.get("LOCALAPPDATA") or data) / "cutis-blender"


def own_python() -> Path | None:
    """The Python of a finished environment, or None."""
    folder = own_folder()
    python = _python_of(folder)
    return python if (folder / _STAMP).is_file() and python.is_file() else None


def _python_of(folder: Path) -> Path:
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
