"""--colorspace, --output-colorspace and --ocio, from capture to maps and back."""

import json

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour import LINEAR, SRGB, rgb_space
from cutis.maps import load_maps
from cutis.textures import Texture, colour_space, read_channels, read_texture, write_texture

CONFIG = """ocio_profile_version: 2
roles: {aces_interchange: reference, default: show_lin}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Raw, colorspace: show_lin}
colorspaces:
  - !<ColorSpace> {name: reference}
  - !<ColorSpace>
    name: show_lin
    aliases: [linear]
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: show_log
    to_scene_reference: !<LogAffineTransform> {base: 10, log_side_slope: 0.25, log_side_offset: 0.5,
      lin_side_slope: 5, lin_side_offset: 0.05, direction: inverse}
"""
SKIN = ("melanin", "blood", "thickness")


@pytest.fixture(autouse=True)
def _no_config(monkeypatch):
    monkeypatch.delenv("OCIO", raising=False)


@pytest.fixture
def config(tmp_path):
    (tmp_path / "show").mkdir()
    path = tmp_path / "show" / "config.ocio"
    path.write_text(CONFIG, encoding="utf-8")
    return path


@pytest.fixture
def captures(face_rgb, tmp_path):
    """`captures("ACEScg", ".exr")` writes the face in that space; `said` is whether it says so."""

    def write(name, suffix=".exr", config=None, said=True, dtype=np.float32):
        space = colour_space(name, config and str(config))
        path = tmp_path / f"{name.replace(' ', '')}{suffix}"
        pixels = np.empty(face_rgb.shape, dtype)
        blank = Texture(pixels, ("R", "G", "B"), space)
        write_texture(blank.with_linear(face_rgb, np.ones(blank.shape, bool)), path, space)
        if not said:
            image = oiio.ImageBuf(str(path))
            for attribute in ("chromaticities", "ICCProfile"):
                image.specmod().erase_attribute(attribute)
            assert image.write(str(path))
        return path

    return write


def estimated(cutis, face, out, *flags):
    ended = cutis("estimate", face, "-o", out, *flags)
    assert (ended.code, ended.err) == (0, "")
    return load_maps(out / f"{face.stem}.skin.exr"), ended.out


def close(skin, other, tolerance=2e-3):
    for name in SKIN:
        np.testing.assert_allclose(getattr(skin, name), getattr(other, name), rtol=tolerance)


def test_the_same_maps_from_every_space(cutis, captures, config, tmp_path):
    expected, _ = estimated(cutis, captures("linear"), tmp_path / "0")
    for number, name in enumerate(("ACEScg", "Rec.2020", "ACES2065-1", "Linear P3-D65")):
        skin, said = estimated(cutis, captures(name), tmp_path / f"a{number}")
        assert "(its chromaticities)" in said, name
        close(skin, expected)
    face = captures("ACEScg", said=False)
    for number, name in enumerate(("ACEScg", "scene_linear", "acescg", "lin_ap1")):
        skin, said = estimated(cutis, face, tmp_path / f"b{number}", "--colorspace", name)
        assert "colour space: ACEScg (given)" in said
        close(skin, expected)
    wrong, said = estimated(cutis, face, tmp_path / "c")
    assert "colour space: linear (assumed, the file says nothing)" in said
    assert abs(wrong.melanin / expected.melanin - 1).max() > 0.02
    face = captures("show_log", config=config)
    flags = ("--colorspace", "show_log", "--ocio", config)
    skin, said = estimated(cutis, face, tmp_path / "d", *flags)
    close(skin, expected)
    assert json.loads((tmp_path / "d" / "show_log.report.json").read_text("utf-8"))[
        "colorspace"
    ] == ("show_log (given)")


def test_profiles_of_integers(cutis, captures, tmp_path):
    expected, _ = estimated(cutis, captures("sRGB", ".png", dtype=np.uint16), tmp_path / "a")
    face = captures("Display P3", ".tif", dtype=np.uint16)
    skin, said = estimated(cutis, face, tmp_path / "b")
    assert "colour space: Display P3 (its ICC profile)" in said
    close(skin, expected)


@pytest.mark.parametrize(
    ("name", "suffix", "dtype"),
    [
        ("ACEScg", ".exr", np.float16),
        ("Display P3", ".png", np.uint8),
        ("Rec.2020", ".tif", np.float32),
        ("show_log", ".exr", np.float16),
        ("show_log", ".tif", np.uint16),
        ("show_log", ".dpx", np.uint16),
    ],
)
def test_edits_come_back_in_the_space_of_the_file(
    cutis, captures, config, tmp_path, name, suffix, dtype, monkeypatch, face_rgb
):
    """Texels off the mask bit for bit, and the same header; the configuration is found again."""
    face = captures(name, suffix, config if "show" in name else None, dtype=dtype)
    flags = ("--colorspace", name, "--ocio", config) if "show" in name else ()
    monkeypatch.chdir(config.parent)
    flags = tuple(flag.name if flag == config else flag for flag in flags)
    estimated(cutis, face, tmp_path / "out", *flags)
    monkeypatch.chdir(tmp_path)
    half = np.zeros((*face_rgb.shape[:2], 3), np.uint8)
    half[:, 16:] = 255
    mask = tmp_path / "mask.png"
    write_texture(Texture(half, ("R", "G", "B"), SRGB), mask)
    edited = tmp_path / f"edited{suffix}"
    maps = tmp_path / "out" / f"{face.stem}.skin.exr"
    ended = cutis("edit", maps, "--melanin", "x2", "--mask", mask, "-o", edited)
    assert (ended.code, ended.err) == (0, "")
    space = colour_space(name, str(config)) if "show" in name else None
    before, after = read_texture(face), read_texture(edited)
    assert after.pixels.dtype == before.pixels.dtype == dtype
    assert (after.space, after.origin) == (before.space, before.origin)
    assert np.array_equal(after.pixels[:, :16], before.pixels[:, :16])
    assert (after.pixels[:, 16:] != before.pixels[:, 16:]).any(axis=-1).all()
    if space is not None:
        after = read_texture(edited, name, str(config))
    ratio = after.linear()[:, 16:] / face_rgb[:, 16:]
    assert ratio.mean() < 0.9
    assert ratio.min() > 0.3


def test_output_space_of_estimate(cutis, captures, tmp_path):
    face = captures("ACEScg")
    estimated(cutis, face, tmp_path / "a")
    estimated(cutis, face, tmp_path / "b", "--output-colorspace", "Rec.2020")
    (linear, said), (wide, tells) = (
        read_channels(tmp_path / folder / "ACEScg.model.exr") for folder in "ab"
    )
    assert (said["colorspace"], tells["colorspace"]) == ("lin_rec709", "Rec.2020")
    rgb, other = (np.stack([c[k] for k in "RGB"], axis=-1) for c in (linear, wide))
    np.testing.assert_allclose(rgb_space("Rec.2020").to_linear_srgb(other), rgb, atol=1e-6)
    for folder, space in (("a", LINEAR), ("b", rgb_space("Rec.2020"))):
        assert read_texture(tmp_path / folder / "ACEScg.model.exr").space == space


@pytest.mark.parametrize(
    ("name", "suffix"),
    [("Display P3", ".png"), ("ACEScg", ".exr"), ("Rec.2020", ".tx"), ("ARRI LogC4", ".tif")],
)
def test_output_space_of_edit(cutis, captures, tmp_path, name, suffix):
    face = captures("sRGB", ".png", dtype=np.uint16)
    estimated(cutis, face, tmp_path / "out")
    maps = tmp_path / "out" / "sRGB.skin.exr"
    edited, plain = tmp_path / f"edited{suffix}", tmp_path / "plain.png"
    assert cutis("edit", maps, "--blood", "x2", "-o", plain).code == 0
    ended = cutis("edit", maps, "--blood", "x2", "-o", edited, "--output-colorspace", name)
    assert (ended.code, ended.err) == (0, "")
    named = name if name.startswith("ARRI") else "auto"
    again = read_texture(edited, named)
    assert again.space == colour_space(name)
    np.testing.assert_allclose(again.linear(), read_texture(plain).linear(), atol=5e-4)


def test_the_environment_names_a_configuration(cutis, captures, config, tmp_path, monkeypatch):
    """Its names come first; what was estimated without it is still read without it."""
    face = captures("linear")
    plain, _ = estimated(cutis, face, tmp_path / "a", "--colorspace", "linear")
    monkeypatch.setenv("OCIO", str(config))
    skin, said = estimated(cutis, face, tmp_path / "b", "--colorspace", "show_lin")
    assert "ACEScg" in said
    assert abs(skin.melanin / plain.melanin - 1).max() > 0.02
    same, _ = estimated(cutis, face, tmp_path / "c")
    close(same, plain, 1e-6)
    header = read_channels(tmp_path / "c" / "linear.model.exr")[1]
    assert header["colorspace"] == "lin_rec709"  # though that configuration calls another so
    edited = tmp_path / "edited.exr"
    maps = tmp_path / "a" / "linear.skin.exr"
    ended = cutis("edit", maps, "--melanin", "x1", "-o", edited)
    assert (ended.code, ended.err) == (0, "")
    np.testing.assert_array_equal(read_texture(edited).pixels, read_texture(face).pixels)


def test_a_broken_environment_matters_only_where_it_is_asked(
    cutis, captures, tmp_path, monkeypatch, one_line
):
    face = captures("ACEScg")
    monkeypatch.setenv("OCIO", str(tmp_path / "gone.ocio"))
    estimated(cutis, face, tmp_path / "a")
    message = one_line(cutis("estimate", face, "--colorspace", "ACEScg", "-o", tmp_path / "b"))
    assert "gone.ocio: not a usable OpenColorIO configuration" in message


def test_names_that_nobody_knows(cutis, captures, config, tmp_path, one_line):
    face = captures("ACEScg")
    for flag in ("--colorspace", "--output-colorspace"):
        message = one_line(cutis("estimate", face, flag, "ACESgc", "-o", tmp_path / "out"))
        assert "unknown colour space 'ACESgc'; did you mean ACEScg" in message
        message = one_line(cutis("estimate", face, flag, "xyzzy", "-o", tmp_path / "out"))
        assert "known are sRGB, linear, ACEScg, Display P3, Rec.2020" in message
        assert len(message) < 300
    message = one_line(
        cutis("estimate", face, "--output-colorspace", "auto", "-o", tmp_path / "out")
    )
    assert "unknown colour space 'auto'" in message
    message = one_line(
        cutis("estimate", face, "--colorspace", "sho_lin", "--ocio", config, "-o", tmp_path / "out")
    )
    assert f"in {config}; did you mean show_lin" in message
    assert "Raw holds data" in one_line(
        cutis("estimate", face, "--colorspace", "Raw", "-o", tmp_path / "out")
    )
    assert not (tmp_path / "out").exists()


def test_without_opencolorio(process, captures, tmp_path):
    """In a process of its own, where it cannot be imported."""
    before = "import sys; sys.modules['PyOpenColorIO'] = None"
    face = captures("ACEScg", said=False)
    done = process(
        "estimate", face, "--colorspace", "ACEScg", "--output-colorspace", "Rec.2020", "-o",
        tmp_path / "out", before=before, OCIO="",
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert "colour space: ACEScg (given)" in done.out
    done = process(
        "estimate", face, "--colorspace", "ACEScct", "-o", tmp_path / "out", before=before, OCIO=""
    )
    assert done.err.count("\n") == 1
    assert "known are sRGB, linear, ACEScg, Display P3, Rec.2020" in done.err
