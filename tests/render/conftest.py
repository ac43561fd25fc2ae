"""Blender, and the files that tests give it."""

import os
import sys
from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.render.blender import find_blender

sys.path.insert(0, str(Path(__file__).parent))  # for the module `render_files`

from render_files import QUARTERS, write_exr


@pytest.fixture(scope="session")
def blender():
    """The Blender that users would get; tests that render are skipped without one."""
    try:
        return find_blender()
    except CutisError as error:
        if os.environ.get("BLENDER"):
            raise
        pytest.skip(f"{error} (or `make blender`)")


@pytest.fixture(scope="session")
def quarters(tmp_path_factory) -> Path:
    """A texture with four colours."""
    path = tmp_path_factory.mktemp("textures") / "quarters.exr"
    return write_exr(path, QUARTERS.repeat(16, 0).repeat(16, 1))
