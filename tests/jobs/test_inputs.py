import numpy as np
import pytest

from cutis.colour import SRGB
from cutis.errors import CutisError
from cutis.jobs.inputs import capture_sets, companion, gaps, odd_ones
from cutis.textures import Texture, write_texture


def picture(path, width=4):
    pixels = np.full((4, width, 3), 120, np.uint8)
    write_texture(Texture(pixels, ("R", "G", "B"), SRGB), path)
    return path


@pytest.fixture
def tiles(tmp_path):
    for number in (1001, 1002, 1004):
        picture(tmp_path / f"face.{number}.png", number - 999)
    return tmp_path


def names(words, udim=False, sequence=False, say=lambda _: None):
    sets = capture_sets([str(word) for word in words], udim, sequence, say)
    return [[path.name for path in one] for one in sets]


def test_tiles_make_one_set(tiles):
    """Where somebody says so: gaps and sizes are then what they are."""
    wanted = ["face.1001.png", "face.1002.png", "face.1004.png"]
    for words, udim in (
        ([str(tiles / "face.<UDIM>.png")], False),
        ([str(tiles / "face.1002.png")], True),
    ):
        (captures,) = capture_sets(words, udim, False)
        assert [path.name for path in captures] == wanted
        assert gaps(captures) == ["face.1003.png"]
        assert odd_ones(captures) == []  # sizes differ, which is usual
    assert companion(tiles / "mask.<UDIM>.png", captures[1]) == tiles / "mask.1002.png"


@pytest.mark.parametrize("head", ["face.", "head_", "a.b_"])
@pytest.mark.parametrize("numbers", [(1001, 1002, 1003), (1001, 1011, 1012), (1001, 1002)])
def test_tiles_that_are_sure_make_one_set(tmp_path, head, numbers):
    wanted = [picture(tmp_path / f"{head}{number}.png").name for number in numbers]
    for words in ([tmp_path], [tmp_path, "*.png"], [tmp_path / "*.png"]):
        told = []
        assert names(words, say=told.append) == [wanted]
        assert told == []


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (["IMG_1234", "IMG_1235", "IMG_1240"], "cameras name their pictures so"),
        (["IMG_1001", "IMG_1002"], "cameras name their pictures so"),
        (["_DSC_1001", "_DSC_1002"], "cameras name their pictures so"),
        (["ann_1234", "ann_1235"], "there is no tile 1001"),
        (["face.1001", "face.1003"], "tile 1002 is missing"),
        (["face.1001", "face.1002-wide"], "their sizes differ"),
    ],
)
def test_names_alone_are_no_evidence(tmp_path, found, why):
    """People and frames are numbered too; each is then calibrated for itself."""
    wanted = []
    for name in found:
        stem, _, wide = name.partition("-")
        wanted.append([picture(tmp_path / f"{stem}.png", 9 if wide else 4).name])
    for words in ([tmp_path], [tmp_path, "*.png"], [f"{tmp_path}/*.png"]):
        told = []
        assert names(words, say=told.append) == wanted
        assert len(told) == 1
        assert why in told[0]
        assert "<UDIM>.png" in told[0]


def test_a_tile_stored_otherwise_is_named(tiles):
    deep = Texture(np.full((4, 4, 3), 9000, np.uint16), ("R", "G", "B"), SRGB)
    write_texture(deep, tiles / "face.1002.png")
    (captures,) = capture_sets([str(tiles / "face.<UDIM>.png")], False, False)
    (line,) = odd_ones(captures)
    assert line.startswith("face.1002.png is odd: it holds uint16")
    assert "most of its set uint8" in line


def test_captures_of_one_name_are_refused(tiles):
    with pytest.raises(CutisError, match=r"called face\.1001 too"):
        capture_sets([str(tiles), str(tiles / "face.1001.png")], False, False)


def test_a_folder_without_images_is_named(tmp_path):
    with pytest.raises(CutisError, match="no image in this folder"):
        capture_sets([str(tmp_path)], False, False)


@pytest.mark.parametrize(
    "name", ["face[1].png", "what?.png", "a*b.png", "[].png", "face.<UDIM>.png"]
)
def test_what_is_there_is_no_pattern(tmp_path, monkeypatch, name):
    show = tmp_path / "show"
    show.mkdir()
    picture(show / "a.png")
    picture(tmp_path / name)
    assert names([show, tmp_path / name]) == [["a.png"], [name]]
    assert names([tmp_path / name]) == [[name]]
    monkeypatch.chdir(tmp_path)
    assert names(["show", name]) == [["a.png"], [name]]


@pytest.mark.parametrize("folder", ["a[1]", "b*", "c?", "d{1}%"])
def test_folders_may_be_called_like_patterns(tmp_path, folder):
    (tmp_path / folder).mkdir()
    picture(tmp_path / folder / "x.png")
    assert names([tmp_path / folder]) == [["x.png"]]
    assert names([tmp_path / folder, "*.png"]) == [["x.png"]]


def test_patterns_inside_a_folder_and_of_their_own(tmp_path, monkeypatch):
    show = tmp_path / "show"
    (show / "deep").mkdir(parents=True)
    for path in (tmp_path / "out.png", show / "in.png", show / "deep" / "below.png"):
        picture(path)
    assert names([show, "*.png"]) == [["in.png"]]
    assert names([show, "**/*.png"]) == [["below.png"], ["in.png"]]
    assert names([show, f"{tmp_path}/*.png"]) == [["in.png"], ["out.png"]]
    assert names([f"{tmp_path}/*.png"]) == [["out.png"]]
    monkeypatch.chdir(tmp_path)
    assert names(["show/*.png"]) == [["in.png"]]
    assert names(["*.png"]) == [["out.png"]]


PATTERNS = ["*.exr", "[", "[!", "**.png*x", "/nowhere/*.png", "a\0*", "*" + "x" * 5000]


@pytest.mark.parametrize("pattern", PATTERNS)
def test_patterns_that_match_nothing_are_one_line(tmp_path, pattern):
    picture(tmp_path / "a.jpg")
    for words in ([tmp_path, pattern], [tmp_path / "a.jpg", pattern]):
        with pytest.raises(CutisError, match="no file matches") as caught:
            names(words)
        assert len(str(caught.value).splitlines()) == 1
