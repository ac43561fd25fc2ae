"""`cutis check`: lines, JSON, exit codes, bad input."""

import json

import numpy as np
import pytest

from cutis.colour import SRGB
from cutis.textures import Texture, read_texture, write_texture


@pytest.fixture(scope="module")
def clean(capture1, tmp_path_factory):
    """A part of the example capture that is nothing but skin."""
    path = tmp_path_factory.mktemp("clean") / "face.png"
    texture = read_texture(capture1[0])
    write_texture(
        Texture(np.ascontiguousarray(texture.pixels[1000:1640, 700:1340]), ("R", "G", "B"), SRGB),
        path,
    )
    return path


def test_a_clean_face(cutis, clean):
    ended = cutis("check", clean)
    assert (ended.code, ended.err) == (0, "")
    assert f"{clean}: " in ended.out
    assert "ITA" in ended.out
    assert "Monk" in ended.out


def test_findings_and_json(cutis, tmp_path):
    grey = np.full((40, 40, 3), 128, np.uint8)
    write_texture(Texture(grey, ("R", "G", "B"), SRGB), tmp_path / "swatch.png")
    ended = cutis("check", tmp_path / "swatch.png")
    assert ended.code == 1
    assert "1 finding" in ended.out
    assert "  finding flat: " in ended.out
    told = cutis("check", tmp_path / "swatch.png", "--json")
    assert told.code == 1
    (found,) = json.loads(told.out)
    assert found["file"] == str(tmp_path / "swatch.png")
    assert found["findings"][0]["kind"] == "flat"


def test_strict_counts_notes(cutis, clean, tmp_path):
    (tmp_path / "ours.toml").write_text("[jpeg-blocks]\nnote = 0.0001\n")
    arguments = ("check", clean, "--thresholds", tmp_path / "ours.toml")
    assert cutis(*arguments).code == 0
    assert cutis(*arguments, "--strict").code == 1


@pytest.mark.parametrize(
    "arguments",
    [("nothing.png",), (), ("--nonsense",), ("face.png", "--thresholds", "gone.toml"),
     ("face.png", "--colorspace", "sRBG")],
)  # fmt: skip
def test_what_cannot_be_checked_ends_with_2(cutis, clean, monkeypatch, arguments):
    monkeypatch.chdir(clean.parent)
    ended = cutis("check", *arguments)
    assert ended.code == 2
    assert ended.err.count("\n") == 1


def test_one_bad_file_of_two(cutis, clean, tmp_path):
    (tmp_path / "bad.png").write_bytes(b"no picture")
    ended = cutis("check", clean, tmp_path / "bad.png")
    assert ended.code == 2
    assert f"{clean}: " in ended.out
    assert "bad.png" in ended.err
