import os
import signal
import subprocess
import sys
import time

import pytest

from cutis.errors import CutisError
from cutis.textures.scratch import scratch_folder, sweep_scratch

HOLD = """
import time
from cutis.textures.scratch import scratch_folder
with scratch_folder() as folder:
    (folder / "deep").mkdir()
    (folder / "deep" / "texture.exr").write_bytes(b"x" * 1000)
    print(folder, flush=True)
    time.sleep(600)
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    return tmp_path


def held(place):
    process = subprocess.Popen([sys.executable, "-c", HOLD], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


def test_a_folder_is_gone_after_its_block(place):
    with scratch_folder() as folder:
        (folder / "a").write_text("a")
        assert folder.parent == place
        assert folder.stat().st_mode & 0o777 == 0o700
    with pytest.raises(ZeroDivisionError), scratch_folder():
        _ = 1 / 0
    assert not list(place.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_what_a_killed_process_left_is_removed_and_what_a_living_one_has_stays(place):
    killed, left = held(place)
    living, used = held(place)
    try:
        killed.send_signal(signal.SIGKILL)
        killed.communicate()
        assert os.path.isdir(left)
        with scratch_folder():
            assert not os.path.exists(left)
            assert os.path.isfile(os.path.join(used, "deep", "texture.exr"))
    finally:
        living.kill()
        living.communicate()


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_only_what_bears_the_mark_is_removed(place):
    thesis = place / "cutis-01234567" / "thesis.txt"
    thesis.parent.mkdir()
    thesis.write_text("precious")
    empty, named = place / "cutis-89abcdef", place / "cutis-notes"
    empty.mkdir()
    named.mkdir()
    (place / "cutis-00000000").symlink_to(named)
    long_ago = time.time() - 3600
    for folder in (thesis.parent, empty, named):
        os.utime(folder, (long_ago, long_ago))
    sweep_scratch(place)
    assert sorted(path.name for path in place.iterdir()) == [
        "cutis-00000000", "cutis-01234567", "cutis-notes",
    ]  # fmt: skip
    assert thesis.read_text() == "precious"


def test_without_a_place_for_it_one_line_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    with pytest.raises(CutisError, match="TMPDIR"), scratch_folder():
        pass
