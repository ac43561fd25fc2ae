"""`cutis figures`."""

import pytest


def test_some_figures(cutis, tmp_path):
    ended = cutis("figures", "--only", "palettes", "--only", "reflectance-series", "-o", tmp_path)
    assert (ended.code, ended.err) == (0, "")
    assert f"wrote {tmp_path / 'reproduction.md'}" in ended.out
    text = (tmp_path / "reproduction.md").read_text("utf-8")
    assert "## Palettes of the albedo space" in text
    assert "## Metamers" not in text
    assert (tmp_path / "reproduction" / "palettes-1.jpg").is_file()


@pytest.mark.parametrize(
    ("flags", "what"),
    [(("--only", "fig3"), "unknown figure 'fig3'"), (("--data", "nowhere"), "no folder albedo")],
)
def test_bad_flags_are_one_line(flags, what, cutis, tmp_path):
    ended = cutis("figures", *flags, "-o", tmp_path / "out")
    assert ended.code == 1
    assert what in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "out").exists()
