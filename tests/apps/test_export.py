"""`cutis export`."""

import pytest


def test_a_lut_is_written(cutis, tmp_path):
    out = tmp_path / "tan.cube"
    ended = cutis("export", out, "--preset", "tanning", "--blood", "x2", "--size", "9")
    assert (ended.code, ended.err) == (0, "")
    assert "melanin x1.4, eumelanin 0.001, blood x2, 9 nodes a side, for sRGB" in ended.out
    lines = out.read_text("utf-8").splitlines()
    assert lines[1] == "LUT_3D_SIZE 9"
    assert len(lines) == 2 + 9**3


def test_the_calibration_of_maps_is_taken(maps, cutis, tmp_path):
    for name, flags in (("a", ()), ("b", ("--maps", maps))):
        out = tmp_path / f"{name}.clf"
        flags = (*flags, "--melanin", "x3", "--size", "17", "--colorspace", "acescg", "-q")
        assert cutis("export", out, *flags).code == 0
    text = (tmp_path / "a.clf").read_text("utf-8")
    assert "LUT1D" in text
    assert "LUT3D" in text


@pytest.mark.parametrize(
    ("flags", "what"),
    [
        ((), "nothing to export"),
        (("--preset", "tan"), "unknown preset"),
        (("--melanin", "lots"), "--melanin takes"),
        (("--preset", "tanning", "--colorspace", "Lab"), "unknown colour space"),
        (("--preset", "tanning", "--size", "1"), "2 to 129"),
        (("--preset", "vitiligo"), "places"),
    ],
)
def test_bad_flags_are_one_line(flags, what, cutis, tmp_path):
    ended = cutis("export", tmp_path / "a.cube", *flags)
    assert ended.code == 1
    assert what in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "a.cube").exists()
