"""Names that are no regular files: nothing is waited for, nothing is read without end."""

import os
import socket
from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.textures import read_mask, read_texture
from cutis.textures.regular import open_regular, read_regular


def test_a_regular_file_is_read(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"12345")
    with open_regular(path, 5) as file:
        assert file.read() == b"12345"
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(CutisError, match="longer than 0 KiB"):
        open_regular(path, 4)


def test_others_are_named(tmp_path, one_line):
    pipe, link = tmp_path / "pipe.png", tmp_path / "link.png"
    os.mkfifo(pipe)
    link.symlink_to("/dev/zero")
    end = socket.socket(socket.AF_UNIX)
    end.bind(str(tmp_path / "s.png"))
    for path, match in [
        (pipe, "is a pipe"),
        (link, "is a device"),
        (Path("/dev/zero"), "is a device"),
        (tmp_path / "s.png", "is a socket"),
        (tmp_path, "is a folder"),
        (tmp_path / "none", "no such file"),
        (tmp_path / "nul\0.png", "is no name of a file"),
    ]:
        for action in (open_regular, read_texture, lambda one: read_mask(one, (4, 4))):
            with pytest.raises(CutisError, match=match) as caught:
                action(path)
            if "\0" not in str(path):
                one_line(caught, path)
    end.close()


def test_a_file_that_may_not_be_read(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.write_bytes(b"1")

    def denied(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(CutisError, match="cannot be read: permission denied; check its rights"):
        open_regular(path)


def test_a_file_that_grows_while_it_is_read(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.write_bytes(b"1")
    real = os.fdopen

    def grown(descriptor, mode):
        with path.open("ab") as more:
            more.write(b"2345")
        monkeypatch.undo()
        return real(descriptor, mode)

    monkeypatch.setattr(os, "fdopen", grown)
    with pytest.raises(CutisError, match="longer"):
        read_regular(path, 2)
