"""`cutis estimate --illuminant`."""

import json
from pathlib import Path

import pytest

from cutis.maps import load_maps


def test_light_by_name_and_by_file(write_face, cutis, tmp_path):
    from cutis.colour import illuminant
    from cutis.colour.observer import wavelengths

    face = write_face(tmp_path)
    rows = "\n".join(f"{w},{p}" for w, p in zip(wavelengths(), illuminant("A"), strict=True))
    (tmp_path / "lamp.csv").write_text(f"wavelength_nm,power\n{rows}\n")
    found = []
    for number, light in enumerate(("A", tmp_path / "lamp.csv")):
        out = tmp_path / str(number)
        ended = cutis("estimate", face, "--illuminant", light, "-o", out)
        assert (ended.code, ended.err) == (0, "")
        assert f"captured under {Path(light).name}" in ended.out
        found.append(load_maps(out / "face.skin.exr"))
        report = json.loads((out / "face.report.json").read_text())
        assert report["calibration"]["illuminant"] == Path(light).name
        assert "captured under" in cutis("info", out / "face.skin.exr").out
    assert (found[0].melanin == found[1].melanin).all()


@pytest.mark.parametrize("light", ["sunshine", "gone.csv"])
def test_bad_lights_are_one_line(light, write_face, cutis, tmp_path):
    ended = cutis("estimate", write_face(tmp_path), "--illuminant", light, "-o", tmp_path / "out")
    assert ended.code == 1
    assert light in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "out").exists()
