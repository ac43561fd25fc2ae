"""Names of UDIM tiles."""

from pathlib import Path

import pytest

from cutis.errors import CutisError
from cutis.textures.udim import missing_tiles, tile_of, udim_pattern, udim_tiles


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("face.1001.exr", "face.<UDIM>.exr"),
        ("face_1011.png", "face_<UDIM>.png"),
        ("a.b.1999.tif", "a.b.<UDIM>.tif"),
        ("face.1001.skin.exr", "face.<UDIM>.skin.exr"),
        ("face.1000.exr", None),
        ("face.2001.exr", None),
        ("face.exr", None),
        ("1001.exr", None),
        ("face1001.exr", None),
    ],
)
def test_patterns(name, pattern):
    assert udim_pattern(Path("x") / name) == (None if pattern is None else Path("x") / pattern)


def test_tiles_are_found_in_order(tmp_path):
    for name in ("f.1011.exr", "f.1001.exr", "g.1002.exr", "f.1002.png", "f.readme.exr"):
        (tmp_path / name).write_bytes(b"")
    found = udim_tiles(tmp_path / "f.<UDIM>.exr")
    assert {number: path.name for number, path in found.items()} == {
        1001: "f.1001.exr", 1011: "f.1011.exr",
    }  # fmt: skip
    assert list(found) == [1001, 1011]
    assert tile_of(tmp_path / "f.<UDIM>.exr", 1011) == found[1011]


@pytest.mark.parametrize("odd", ["f.0999.exr", "f.10010.exr", "f.2000.exr", "f.7.exr"])
def test_odd_tiles_are_named(tmp_path, odd):
    for name in ("f.1001.exr", odd):
        (tmp_path / name).write_bytes(b"")
    with pytest.raises(CutisError, match="no UDIM tile") as caught:
        udim_tiles(tmp_path / "f.<UDIM>.exr")
    assert odd in str(caught.value)


def test_nothing_there(tmp_path):
    with pytest.raises(CutisError, match="no tile is there"):
        udim_tiles(tmp_path / "f.<UDIM>.exr")
    with pytest.raises(CutisError, match="does not exist"):
        udim_tiles(tmp_path / "gone" / "f.<UDIM>.exr")


def test_gaps_lie_inside_a_row():
    assert missing_tiles([1001, 1002, 1005, 1011, 1013]) == [1003, 1004, 1012]
    assert missing_tiles([1001, 1011, 1021]) == []
