"""Where the studio keeps what belongs to a face, and what its outputs are called."""

import hashlib
import os
import re
from pathlib import Path

from cutis.errors import CutisError

ENDING = ".studio"
"""Of the folder beside a face that holds its maps and its history."""
LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _-]{0,39}")
"""What people may add to the name of an output: nothing that could lead elsewhere."""
MOST = 999
"""Outputs of one label."""


def project_folder(face: Path, beside_it: bool = True) -> Path:
    """The folder of a face, made: FACE.studio `beside_it`, else one in the user's cache.

    Only the user may look into it. Raises CutisError where neither can be made.
    """
    beside = face.with_name(face.name + ENDING)
    for folder in (*((beside,) if beside_it else ()), _kept_elsewhere(face)):
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK | os.X_OK):
            return folder
    raise CutisError(f"{beside}: cannot make this folder; open a face whose folder you may write")


def _kept_elsewhere(face: Path) -> Path:
    from numba.misc.appdirs import AppDirs

    whole = hashlib.sha256(os.fsencode(os.path.abspath(face))).hexdigest()[:16]
    return Path(AppDirs("cutis", appauthor=False).user_cache_dir) / f"{face.name}-{whole}{ENDING}"


def output_name(folder: Path, stem: str, label: str, ending: str) -> Path:
    """STEM.LABEL.EXT in a folder, or with a number where that is taken: nothing is written over.

    Raises CutisError for labels that are more than a few letters, digits, spaces and dashes.
    """
    if not LABEL.fullmatch(label):
        raise CutisError("a name takes up to 40 letters, digits, spaces, - and _")
    for number in range(1, MOST):
        path = folder / f"{stem}.{label}{'' if number == 1 else f'-{number}'}{ending}"
        if not os.path.lexists(path):
            return path
    raise CutisError(f"{folder} holds {MOST} files called {label}; take another name")
