"""Maps that went through another program, which kept their channels and dropped their header."""

import json

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

WARM = (0.88, 1.0, 1.05)
KEPT = ("melanin", "blood", "thickness", "eumelanin", "oxygenation", "mask")


@pytest.fixture
def bare(write_face, cutis, tmp_path):
    """Maps of a balanced capture, and the same channels in a file without a header."""
    face = write_face(tmp_path)
    gains = ",".join(map(str, WARM))
    assert cutis("estimate", face, "--white", gains, "-o", tmp_path / "out").code == 0
    maps = tmp_path / "out" / f"{face.stem}.skin.exr"
    source = oiio.ImageInput.open(str(maps))
    names, pixels = list(source.spec().channelnames), source.read_image("float")
    source.close()
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(KEPT), "float")
    spec.channelnames = KEPT
    path = tmp_path / "bare.skin.exr"
    sink = oiio.ImageOutput.create(str(path))
    assert sink.open(str(path), spec)
    assert sink.write_image(np.ascontiguousarray(pixels[..., [names.index(n) for n in KEPT]]))
    sink.close()
    return path, face, maps


def codes(path):
    return np.asarray(Image.open(path)).astype(int)


def edited(cutis, maps, out, *flags):
    ended = cutis("edit", maps, "--melanin", "x1.4", *flags, "-o", out)
    assert (ended.code, ended.err) == (0, "")
    return ended.out


def test_what_is_taken_is_said_and_what_is_right_can_be_named(bare, cutis, tmp_path):
    path, face, maps = bare
    edited(cutis, maps, tmp_path / "right.png")
    said = edited(cutis, path, tmp_path / "guess.png", "--source", face)
    assert "bare.skin.exr says no model and no calibration" in said
    assert "measured2026 and gains of 1 taken" in said
    assert "--model NAME --calibration R,G,B" in said
    report = f"{maps}".replace(".skin.exr", ".report.json")
    for which in (",".join(map(str, WARM)), report):
        flags = ("--model", "measured2026", "--calibration", which)
        said = edited(cutis, path, tmp_path / "named.png", "--source", face, *flags)
        assert "says no" not in said
        assert np.abs(codes(tmp_path / "named.png") - codes(tmp_path / "right.png")).max() <= 1
    assert "says no model" in cutis("info", path).out


def test_a_report_beside_is_pointed_at(bare, cutis, tmp_path):
    path, face, maps = bare
    report = tmp_path / "bare.report.json"
    report.write_text((maps.parent / f"{face.stem}.report.json").read_text())
    said = edited(cutis, path, tmp_path / "a.png", "--source", face)
    assert "--model measured2026 --calibration bare.report.json" in said
    for content in ("[]", "[" * 100_000, '{"model": 3}', "\x00", json.dumps({"calibration": []})):
        report.write_text(content)
        assert "--model NAME" in edited(cutis, path, tmp_path / "a.png", "--source", face)


def test_maps_are_mended_without_an_edit(bare, cutis, tmp_path):
    path, face, maps = bare
    mended = tmp_path / "mended.skin.exr"
    ended = cutis("edit", path, "--source", face, "--model", "measured2026", "--calibration",
                  "0.88,1,1.05", "--save-maps", mended, "-o", tmp_path / "same.png")  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    assert np.array_equal(codes(tmp_path / "same.png"), codes(face))
    said = edited(cutis, mended, tmp_path / "mended.png")
    assert "says no" not in said
    edited(cutis, maps, tmp_path / "right.png")
    assert np.abs(codes(tmp_path / "mended.png") - codes(tmp_path / "right.png")).max() <= 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0.9,1", "three numbers"),
        ("1,1,99", "three numbers"),
        ("warm", "NAME.report.json"),
        ("none.report.json", "no such file"),
        ("0.9,1,nan", "three numbers"),
    ],
)
def test_calibrations_that_are_none(bare, cutis, one_line, tmp_path, text, message):
    path, face, _ = bare
    ended = cutis("edit", path, "--source", face, "--melanin", "x2", "--calibration", text, "-o",
                  tmp_path / "a.png")  # fmt: skip
    assert message in one_line(ended)
    assert not (tmp_path / "a.png").exists()
