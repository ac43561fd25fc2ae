import ctypes
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

import cutis.errors
from cutis.colour import SRGB
from cutis.errors import CutisError
from cutis.textures import Texture, read_texture, write_texture

SOURCE = str(Path(cutis.errors.__file__).parents[1])
SCRIPT = """
    import os, resource, sys
    from pathlib import Path
    import numpy as np
    from cutis.errors import CutisError
    from cutis.colour import LINEAR, SRGB
    from cutis.textures import Texture, read_texture, write_texture

    folder, name, dtype = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    random = np.random.default_rng(1)
    kind = np.dtype(dtype).kind
    pixels = (random.random((90, 70, 3)) * (255 if kind == "u" else 1)).astype(dtype)
    one = Texture(pixels, ("R", "G", "B"), SRGB if kind == "u" else LINEAR)
    path = folder / name
    write_texture(one, path)
    size, hard = path.stat().st_size, resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    whole = read_texture(path).pixels
    path.unlink()
    seen = set()
    for limit in [0, 1, 100, 300, size // 3, size // 2, *range(size - 300, size + 9, 7), size * 9]:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
        try:
            write_texture(one, path)
        except CutisError as error:
            assert len(str(error).splitlines()) == 1 and str(path) in str(error), error
            assert ".partial" not in str(error), error  # the name that nobody is to see
            assert os.listdir(folder) == [], (limit, os.listdir(folder))
            seen.add("failed")
        else:
            assert os.listdir(folder) == [name]
            assert np.array_equal(read_texture(path).pixels, whole), limit
            path.unlink()
            seen.add("written")
    print(*sorted(seen))
"""


@pytest.mark.parametrize(
    ("name", "dtype"),
    [
        ("a.png", "uint8"),
        ("a.jpg", "uint8"),
        ("a.tif", "uint8"),
        ("a.tif", "float32"),
        ("a.exr", "float16"),
        ("a.tx", "uint8"),
        ("a.dpx", "uint8"),
    ],
)
def test_a_disk_that_fills_leaves_nothing(tmp_path, name, dtype):
    pytest.importorskip("resource")
    command = [sys.executable, "-W", "error", "-c", textwrap.dedent(SCRIPT)]
    done = subprocess.run(
        [*command, str(tmp_path), name, dtype],
        env={"PYTHONPATH": SOURCE, "PATH": ""},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.stdout.split() == ["failed", "written"], done.stderr
    assert done.stderr == ""


READ_ONLY, DETACH = 1, 2


@pytest.fixture
def mount(tmp_path):
    """Mounts a file system of 64 KiB on a folder, with flags; only root may."""
    if not sys.platform.startswith("linux"):
        pytest.skip("tmpfs is Linux")
    libc, folder = ctypes.CDLL(None), str(tmp_path).encode()
    mounted = []

    def mount(flags=0):
        if libc.mount(b"tmpfs", folder, b"tmpfs", flags, b"size=64k"):
            pytest.skip("mounting needs rights this process lacks")
        mounted.append(folder)
        return tmp_path

    yield mount
    for one in mounted:
        libc.umount2(one, DETACH)


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.exr", "a.tx", "a.dpx"])
def test_a_read_only_disk_is_explained(mount, one_line, name):
    path = mount(READ_ONLY) / name
    with pytest.raises(CutisError, match="read-only file system") as caught:
        write_texture(Texture(np.zeros((2, 2, 3), np.uint8), ("R", "G", "B"), SRGB), path)
    one_line(caught, path)


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.exr", "a.tx", "a.dpx"])
def test_a_full_disk_leaves_what_was_there(mount, one_line, name):
    small_disk = mount()
    noise = np.random.default_rng(1).integers(0, 256, (400, 400, 3)).astype(np.uint8)
    path = small_disk / name
    small = Texture(noise[:8, :8], ("R", "G", "B"), SRGB)
    write_texture(small, path)
    before = path.read_bytes()
    with pytest.raises(CutisError, match="cannot be written") as caught:
        write_texture(Texture(noise, ("R", "G", "B"), SRGB), path)
    assert ".partial" not in one_line(caught, path)
    assert path.read_bytes() == before
    assert list(small_disk.iterdir()) == [path]


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.exr", "a.tx", "a.dpx"])
def test_missing_folder(tmp_path, one_line, name):
    path = tmp_path / "no" / name
    with pytest.raises(CutisError, match="does not exist") as caught:
        write_texture(Texture(np.zeros((2, 2, 3), np.uint8), ("R", "G", "B"), SRGB), path)
    one_line(caught, path)


def test_odd_names(tmp_path):
    one = Texture(np.zeros((2, 2, 3), np.uint8), ("R", "G", "B"), SRGB)
    for name in ["é ü.png", "a#1?x=2.png", "%04d.exr", "a:b.jpg", "-.tif", "x" * 240 + ".png"]:
        write_texture(one, tmp_path / name)
        assert read_texture(tmp_path / name).shape == (2, 2)
