"""`cutis info` says what is in a file of maps."""

from cutis.maps import DEFAULT, load_maps
from cutis.optics import NAMES


def test_info(cutis, maps):
    ended = cutis("info", maps)
    assert (ended.code, ended.err) == (0, "")
    assert "face.skin.exr: 32 × 24 texels, 100.0 % skin" in ended.out
    assert f"model {DEFAULT}; gains 1.0000, 1.0000, 1.0000 (none)" in ended.out
    assert "source: ../face.png" in ended.out
    for name in NAMES:
        assert name in ended.out


def test_edits_are_listed(cutis, maps, tmp_path):
    edited = load_maps(maps).multiply(melanin=1.4).replace(blood=0.1)
    edited.save(tmp_path / "edited.exr")
    ended = cutis("info", tmp_path / "edited.exr")
    assert "edit: melanin x1.4\nedit: blood 0.1\n" in ended.out
