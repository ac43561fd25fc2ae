"""`cutis estimate` writes what it promises, and says what it wrote."""

import json

import numpy as np
import pytest
from PIL import Image

import cutis as package
from cutis.checks import Examined
from cutis.maps import DEFAULT, estimate, load_maps, load_model
from cutis.optics import NAMES
from cutis.report import report
from cutis.textures import read_channels

MAPS = [f"face.{name}.png" for name in NAMES]
TRUST = ["face.sigma.png", "face.confidence.png"]
PLAIN = ["face.skin.exr", "face.model.exr", "face.report.json", "face.error.png", *MAPS]
PROMISED = sorted([*PLAIN, *(TRUST if load_model().to_trust else [])])


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_it_writes_these_files_and_no_others(estimated):
    assert names(estimated) == PROMISED
    assert names(estimated.parent) == ["face.png", "out"]


def test_maps_model_and_report_are_those_of_the_library(estimated):
    skin = estimate(package.read(estimated.parent / "face.png"))
    stored = load_maps(estimated / "face.skin.exr")
    np.testing.assert_array_equal(stored.parameters(), skin.parameters())
    channels, header = read_channels(estimated / "face.model.exr")
    model = np.stack([channels[name] for name in "RGB"], axis=-1)
    np.testing.assert_array_equal(model, skin.model_albedo)
    assert header["colorspace"] == "lin_rec709"
    found = json.loads((estimated / "face.report.json").read_text("utf-8"))
    said = found.pop("colorspace")
    assert said == "sRGB (its sRGB chunk)"
    files, made_from = found.pop("files"), found.pop("made_from")
    assert found == json.loads(json.dumps(report(skin)))
    assert all((estimated / name).is_file() for name in files)
    assert made_from["asked"]["capture"] == "face.png"


def test_previews_are_pictures(estimated):
    for path in estimated.glob("*.png"):
        with Image.open(path) as picture:
            assert picture.width > 32
            assert picture.height >= 24


def test_it_says_what_it_found(write_face, cutis, tmp_path):
    face = write_face(tmp_path)
    ended = cutis("estimate", face, "-o", tmp_path / "new" / "out", "--white", "1,1,1.02")
    assert (ended.code, ended.err) == (0, "")
    assert f"gains 1.000, 1.000, 1.020 (given), model {DEFAULT}" in ended.out
    for name in NAMES:
        assert name in ended.out
    assert "ΔE00 mean" in ended.out
    assert "albedo" not in ended.out
    assert names(tmp_path / "new" / "out") == PROMISED


def test_quiet(write_face, cutis, tmp_path):
    ended = cutis("estimate", write_face(tmp_path), "-o", tmp_path / "out", "--quiet")
    assert (ended.code, ended.out, ended.err) == (0, "", "")


def test_twice_into_one_folder_gives_the_same(write_face, cutis, tmp_path):
    face, out = write_face(tmp_path), tmp_path / "out"
    contents = []
    for _ in range(2):
        assert cutis("estimate", face, "-o", out, "-q").code == 0
        assert names(out) == PROMISED
        contents.append(load_maps(out / "face.skin.exr").parameters())
    np.testing.assert_array_equal(*contents)


def test_dots_in_names(write_face, cutis, tmp_path):
    face = write_face(tmp_path, "exr", name="face.v2.1001")
    assert cutis("estimate", face, "-o", tmp_path / "out.d", "-q").code == 0
    expected = [name.replace("face.", "face.v2.1001.", 1) for name in PROMISED]
    assert names(tmp_path / "out.d") == sorted(expected)
    skin = load_maps(tmp_path / "out.d" / "face.v2.1001.skin.exr")
    assert skin.provenance["source"] == "../face.v2.1001.exr"
    assert skin.provenance["source_colorspace"] == "auto"


def test_mask_model_half_and_colour_space(write_face, face_mask, cutis, tmp_path):
    face = write_face(tmp_path)
    Image.fromarray((face_mask * 255).astype(np.uint8)).save(tmp_path / "mask.png")
    ended = cutis(
        "estimate", face, "--mask", tmp_path / "mask.png", "--model", "aliaga2022", "--half",
        "--colorspace", "linear", "-o", tmp_path,
    )  # fmt: skip
    assert ended.code == 0, ended.err
    skin = load_maps(tmp_path / "face.skin.exr")
    assert skin.model == "aliaga2022"
    assert skin.provenance["source_colorspace"] == "linear"
    np.testing.assert_allclose(skin.mask, face_mask, atol=0.003)
    direct = estimate(package.read(face, "linear"), skin.mask, model="aliaga2022")
    np.testing.assert_allclose(skin.melanin, direct.melanin, rtol=1e-3)


def test_a_mask_with_nothing_of_skin_colour(cutis, tmp_path):
    Image.new("RGB", (40, 30), (20, 20, 120)).save(tmp_path / "face.png")
    ended = cutis("estimate", tmp_path / "face.png", "-o", tmp_path / "out")
    assert (ended.code, ended.err) == (0, "")
    assert "no texel inside the mask has the colour of skin" in ended.out
    assert names(tmp_path / "out") == PROMISED


@pytest.mark.parametrize("size", [(1, 1), (2000, 1), (3, 1000)])
def test_odd_sizes(size, cutis, tmp_path):
    Image.new("RGB", size, (200, 140, 120)).save(tmp_path / "face.png")
    ended = cutis("estimate", tmp_path / "face.png", "-o", tmp_path / "out", "-q")
    assert (ended.code, ended.out, ended.err) == (0, "", "")
    assert names(tmp_path / "out") == PROMISED


def test_a_mask_between_the_texels_of_previews(cutis, tmp_path):
    """Previews take every n-th texel; a mask may miss them all."""
    Image.new("RGB", (1900, 4), (200, 140, 120)).save(tmp_path / "face.png")
    mask = np.zeros((4, 1900), np.uint8)
    mask[1, 1] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    ended = cutis(
        "estimate", tmp_path / "face.png", "--mask", tmp_path / "mask.png", "-o", tmp_path, "-q"
    )
    assert (ended.code, ended.out, ended.err) == (0, "", "")


def test_sigma_goes_into_maps_pictures_report_and_words(
    trusting, write_face, cutis, tmp_path, monkeypatch
):
    # the confidence of this model is made up, and no judge of the input
    monkeypatch.setattr("cutis.jobs.estimate.examine", lambda gathered: Examined(()))
    face, out = write_face(tmp_path), tmp_path / "out"
    ended = cutis("estimate", face, "-o", out, "--report")
    assert (ended.code, ended.err) == (0, "")
    assert "melanin: well known, ±" in ended.out
    assert "oxygenation: hardly known, ±0." in ended.out
    assert "RGB fixes melanin and blood well" not in ended.out
    assert names(out) == sorted([*PLAIN, *TRUST, "face.report.html"])
    stored, skin = load_maps(out / "face.skin.exr"), estimate(package.read(face))
    for name in NAMES:
        np.testing.assert_allclose(stored.sigma(name), skin.sigma(name), rtol=1e-3)
    found = json.loads((out / "face.report.json").read_text("utf-8"))
    assert found["maps"] == json.loads(json.dumps(report(skin)))["maps"]
    assert "well known" in (out / "face.report.html").read_text("utf-8")
    ended = cutis("info", out / "face.skin.exr")
    assert "melanin: well known, ±" in ended.out


def test_sigma_can_be_left_out(trusting, write_face, cutis, tmp_path):
    ended = cutis("estimate", write_face(tmp_path), "-o", tmp_path / "out", "--no-sigma")
    assert (ended.code, ended.err) == (0, "")
    assert names(tmp_path / "out") == sorted(PLAIN)
    channels, _ = read_channels(tmp_path / "out" / "face.skin.exr")
    assert set(channels) == {*NAMES, "mask"}
    assert "known" not in cutis("info", tmp_path / "out" / "face.skin.exr").out
