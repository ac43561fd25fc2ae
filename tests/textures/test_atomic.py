import os
import stat
from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.textures import check_writable, replacing, sweep


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


def test_system_errors_about_the_file_are_explained(tmp_path):
    with pytest.raises(CutisError, match="no space left"), replacing(tmp_path / "full"):
        raise OSError(28, "No space left on device")
    assert not list(tmp_path.iterdir())


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


@pytest.mark.parametrize("letter", ["y", "ä", "語", "🙂"])
def test_names_as_long_as_names_may_be(tmp_path, letter, one_line):
    """Bytes count, and the temporary name is no longer."""
    longest = os.pathconf(tmp_path, "PC_NAME_MAX")
    count = (longest - 4) // len(letter.encode())
    path = tmp_path / f"{letter * count}.txt"
    check_writable(path)
    with replacing(path) as temporary:
        temporary.write_text("x")
    assert path.read_text() == "x"
    path = tmp_path / f"{letter * (count + 1)}.txt"
    for action in (lambda: check_writable(path), lambda: replacing(path).__enter__()):
        with pytest.raises(
            CutisError, match=f"longer than {longest} bytes; choose a sho"
        ) as caught:
            action()
        one_line(caught, path)
    assert len(list(tmp_path.iterdir())) == 1


def test_a_path_longer_than_paths_may_be(tmp_path):
    path = tmp_path.joinpath(*["folder"] * 700, "a.txt")
    with pytest.raises(CutisError, match=r"does not exist|path is longer|too long"):
        check_writable(path)


def test_what_is_no_file_is_never_replaced(tmp_path, one_line):
    pipe, link, null = tmp_path / "pipe.csv", tmp_path / "link.csv", tmp_path / "null.csv"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    null.symlink_to("/dev/null")
    before = sorted(tmp_path.iterdir())
    for path, what in [(pipe, "is a pipe"), (link, "is a pipe"), (null, "is a device"),
                       (Path("/dev/null"), "is a device")]:  # fmt: skip
        for action in (lambda one: check_writable(one), lambda one: replacing(one).__enter__()):
            with pytest.raises(CutisError, match=f"{what}.*; give the name of a file") as caught:
                action(path)
            one_line(caught, path)
    assert stat.S_ISFIFO(pipe.lstat().st_mode)
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    assert sorted(tmp_path.iterdir()) == before


def test_a_link_to_nothing_is_followed(tmp_path):
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "target")
    with replacing(link) as temporary:
        temporary.write_text("x")
    assert (tmp_path / "target").read_text() == "x"
    assert link.is_symlink()


def test_every_writer_clears_what_others_left(tmp_path):
    """Once a process and folder; nothing that somebody else called so."""
    left = tmp_path / ".old.0123abcd.partial.exr"
    names = (".old.0123abcd.exr", ".old.0123ABCD.partial.exr", "old.0123abcd.partial.exr",
             ".b.0123abcd.partial.exr")  # fmt: skip
    others = [tmp_path / name for name in names]
    for path in (left, *others[:3]):
        path.write_bytes(b"x")
        os.utime(path, (1, 1))
    others[3].mkdir()
    os.utime(others[3], (1, 1))
    with replacing(tmp_path / "new") as temporary:
        temporary.write_text("x")
    assert not left.exists()
    assert all(path.exists() for path in others)
