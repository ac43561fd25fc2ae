import os
import stat

import pytest

from cutis.errors import CutisError
from cutis.textures import replacing, sweep


def test_the_file_appears_whole(tmp_path):
    path = tmp_path / "report.json"
    with replacing(path) as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".json"
        temporary.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, CutisError])
def test_a_failure_leaves_what_was_there(tmp_path, error):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise error("stop")

    with pytest.raises(error):
        fail()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_links_and_modes_are_kept(tmp_path):
    target, link = tmp_path / "target.txt", tmp_path / "link.txt"
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(target)
    with replacing(link) as temporary:
        temporary.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_new_file_follows_the_umask(tmp_path):
    old = os.umask(0o027)
    try:
        with replacing(tmp_path / "a") as temporary:
            temporary.write_text("x")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


def test_missing_folder_and_folder_as_name(tmp_path, one_line):
    for path, match in [(tmp_path / "no" / "a.txt", "does not exist"), (tmp_path, "is a folder")]:
        with pytest.raises(CutisError, match=match) as caught, replacing(path):
            pass
        one_line(caught, path)


def test_system_errors_about_the_file_are_explained(tmp_path, one_line):
    path = tmp_path / ("x" * 40) / ("y" * 300 + ".txt")
    path.parent.mkdir()
    with pytest.raises(CutisError, match="cannot be written") as caught, replacing(path) as t:
        t.write_text("x")
    one_line(caught, path)
    with pytest.raises(CutisError, match="no space left"), replacing(tmp_path / "full"):
        raise OSError(28, "No space left on device")
    assert list(tmp_path.iterdir()) == [path.parent]


def test_errors_about_other_files_pass(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "a.txt"):
        (tmp_path / "other").read_text()
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(getattr(os, "geteuid", int)() == 0, reason="root may write anywhere")
def test_unwritable_folder(tmp_path, one_line):
    tmp_path.chmod(0o500)
    with pytest.raises(CutisError, match="cannot be written"), replacing(tmp_path / "a.txt"):
        pass


def test_what_killed_processes_left_is_swept(tmp_path):
    """Not what is being written, not what others called so."""
    left = tmp_path / ".face.0123abcd.partial.exr"
    others = [tmp_path / ".partial.exr", tmp_path / ".face.partial.exr", tmp_path / "face.exr"]
    for path in (left, *others):
        path.write_bytes(b"x")
        os.utime(path, (1, 1))
    with replacing(tmp_path / "new.exr") as temporary:
        temporary.write_bytes(b"whole")
        os.utime(temporary, (1, 1))
        sweep(tmp_path)
        assert temporary.exists()
        assert not left.exists()
    assert all(path.exists() for path in others)
    assert (tmp_path / "new.exr").read_bytes() == b"whole"
