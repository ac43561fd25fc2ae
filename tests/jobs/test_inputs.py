import numpy as np
import pytest

from cutis.colour import SRGB
from cutis.errors import CutisError
from cutis.jobs.inputs import capture_sets, companion, gaps, odd_ones
from cutis.textures import Texture, write_texture


@pytest.fixture
def tiles(tmp_path):
    for number in (1001, 1002, 1004):
        pixels = np.full((4, number - 999, 3), 120, np.uint8)
        write_texture(Texture(pixels, ("R", "G", "B"), SRGB), tmp_path / f"face.{number}.png")
    return tmp_path


def test_tiles_make_one_set(tiles):
    names = ["face.1001.png", "face.1002.png", "face.1004.png"]
    for words, udim in (
        ([str(tiles)], False),
        ([str(tiles), "*.png"], False),
        ([str(tiles / "face.<UDIM>.png")], False),
        ([str(tiles / "face.1002.png")], True),
    ):
        (captures,) = capture_sets(words, udim, False)
        assert [path.name for path in captures] == names
        assert gaps(captures) == ["face.1003.png"]
        assert odd_ones(captures) == []  # sizes differ, which is usual
    assert companion(tiles / "mask.<UDIM>.png", captures[1]) == tiles / "mask.1002.png"


def test_a_tile_stored_otherwise_is_named(tiles):
    deep = Texture(np.full((4, 4, 3), 9000, np.uint16), ("R", "G", "B"), SRGB)
    write_texture(deep, tiles / "face.1002.png")
    (captures,) = capture_sets([str(tiles)], False, False)
    (line,) = odd_ones(captures)
    assert line.startswith("face.1002.png is odd: it holds uint16")
    assert "most of its set uint8" in line


def test_captures_of_one_name_are_refused(tiles):
    with pytest.raises(CutisError, match=r"called face\.1001 too"):
        capture_sets([str(tiles), str(tiles / "face.1001.png")], False, False)


def test_a_folder_without_images_is_named(tmp_path):
    with pytest.raises(CutisError, match="no image"):
        capture_sets([str(tmp_path)], False, False)
