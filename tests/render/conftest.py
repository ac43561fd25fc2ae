"""Files that tests give Blender."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for the module `render_files`

from render_files import QUARTERS, write_exr


@pytest.fixture(scope="session")
def quarters(tmp_path_factory) -> Path:
    """A texture with four colours."""
    path = tmp_path_factory.mktemp("textures") / "quarters.exr"
    return write_exr(path, QUARTERS.repeat(16, 0).repeat(16, 1))
