"""`cutis export`."""

import numpy as np
import OpenImageIO as oiio
import pytest


def applied(path, stored):
    """(n, 3) values through a LUT file, as OpenColorIO reads it."""
    buffer = oiio.ImageBuf(oiio.ImageSpec(len(stored), 1, 3, "float"))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(stored, np.float32)[None])
    result = oiio.ImageBufAlgo.ociofiletransform(buffer, str(path))
    assert not result.has_error, result.geterror()
    return result.get_pixels(oiio.FLOAT)[0]


def test_a_lut_is_written(cutis, tmp_path):
    out = tmp_path / "tan.cube"
    ended = cutis("export", out, "--preset", "tanning", "--blood", "x2", "--size", "9")
    assert (ended.code, ended.err) == (0, "")
    said = "tanning: melanin x1.4; tanning: eumelanin 0.001; blood x2, for sRGB, 9 nodes a side"
    assert said in " ".join(ended.out.split())
    lines = out.read_text("utf-8").splitlines()
    assert lines[0] == f"# {said.removesuffix(', 9 nodes a side')}"
    assert lines[1] == "LUT_3D_SIZE 9"
    assert len(lines) == 2 + 9**3


def test_a_lut_of_a_rare_chromophore(cutis, tmp_path):
    ended = cutis("export", tmp_path / "ill.cube", "--preset", "jaundice", "--size", "17")
    assert (ended.code, ended.err) == (0, "")
    light = np.array([[0.85, 0.68, 0.58]])
    red, green, blue = (applied(tmp_path / "ill.cube", light) - light)[0]
    assert blue < -0.02 < green < red + 0.01


def test_the_calibration_of_maps_is_taken(maps, cutis, tmp_path):
    """A LUT made for a capture that was balanced differs from one that was not."""
    from dataclasses import replace

    from cutis.inverse import Calibration
    from cutis.maps import load_maps, save_maps

    balanced = replace(load_maps(maps), calibrated=Calibration((0.8, 1.0, 1.2), "given"))
    save_maps(balanced, tmp_path / "balanced.skin.exr")
    skins = np.array([[0.6, 0.4, 0.32], [0.7, 0.5, 0.4], [0.4, 0.28, 0.22]])
    found = []
    for name, flags in (
        ("a", ()),
        ("b", ("--maps", maps)),
        ("c", ("--maps", tmp_path / "balanced.skin.exr")),
    ):
        out = tmp_path / f"{name}.clf"
        flags = (*flags, "--melanin", "x3", "--size", "17", "--colorspace", "acescg", "-q")
        ended = cutis("export", out, *flags)
        assert (ended.code, ended.out, ended.err) == (0, "", "")
        found.append(applied(out, skins))
    assert np.array_equal(found[0], found[1])  # those maps are of a capture without gains
    assert np.abs(found[0] - found[2]).max() > 0.01


def test_the_default_is_written_as_glsl(cutis, tmp_path):
    ended = cutis("export", tmp_path / "decoder.glsl")
    assert (ended.code, ended.err) == (0, "")
    assert "decoder of measured2026, with its table in decoder.table.f16" in ended.out
    text = (tmp_path / "decoder.glsl").read_text("ascii")
    assert "vec3 cutis_albedo(" in text
    assert "decoder.table.f16" in text
    assert (tmp_path / "decoder.table.f16").stat().st_size == 3_240_576


def test_the_default_is_written_as_onnx(cutis, tmp_path):
    onnx = pytest.importorskip("onnx", reason="the extra onnx is not installed")
    ended = cutis("export", tmp_path / "decoder.onnx")
    assert (ended.code, ended.err) == (0, "")
    assert "decoder of measured2026" in ended.out
    model = onnx.load(tmp_path / "decoder.onnx")
    assert [i.name for i in model.graph.input] == ["skin"]


def test_glsl_of_networks_is_written(cutis, tmp_path):
    ended = cutis("export", tmp_path / "decoder.glsl", "--model", "aliaga2022")
    assert (ended.code, ended.err) == (0, "")
    assert "decoder of aliaga2022" in ended.out
    assert not (tmp_path / "decoder.table.f16").exists()


@pytest.mark.parametrize("half", ["encoder", "decoder"])
def test_onnx_is_written(half, cutis, tmp_path):
    onnx = pytest.importorskip("onnx", reason="the extra onnx is not installed")
    ended = cutis("export", tmp_path / f"{half}.onnx", "--model", "aliaga2022")
    assert (ended.code, ended.err) == (0, "")
    model = onnx.load(tmp_path / f"{half}.onnx")
    assert [i.name for i in model.graph.input] == ["rgb" if half == "encoder" else "skin"]


@pytest.mark.parametrize(
    ("name", "flags", "what"),
    [
        ("a.cube", (), "nothing to export"),
        ("a.cube", ("--preset", "tann"), "unknown preset"),
        ("a.cube", ("--melanin", "lots"), "--melanin takes"),
        ("a.cube", ("--preset", "tanning", "--colorspace", "Lab"), "unknown colour space"),
        ("a.cube", ("--preset", "tanning", "--size", "1"), "2 to 129"),
        ("a.clf", ("--preset", "tanning", "--size", "8"), "9 to 129"),
        ("a.cube", ("--preset", "vitiligo"), "places"),
        ("a.cube", ("--preset", "tanning", "--amount", "2"), "0 to 1"),
        ("a.lut", ("--preset", "tanning"), ".cube or .clf"),
        ("a.cube", ("--preset", "tanning", "--model", "none"), "unknown model"),
        ("decoder.onnx", ("--preset", "tanning"), "is for networks"),
        ("decoder.onnx", ("--model", "kubelka-munk"), "not a pair of networks"),
        ("encoder.onnx", (), "is no network"),
        ("encoder.glsl", (), "only the decoder"),
    ],
)
def test_bad_flags_are_one_line(name, flags, what, cutis, tmp_path, one_line):
    ended = cutis("export", tmp_path / name, *flags)
    assert what in one_line(ended)
    assert not (tmp_path / name).exists()
