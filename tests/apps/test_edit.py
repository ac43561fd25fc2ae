"""`cutis edit`: what was not edited comes back, what was is stored as the capture is."""

import hashlib

import numpy as np
import pytest

import cutis as package
from cutis.looks import presets
from cutis.maps import load_maps


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_relit_is_what_the_library_gives(maps, cutis, tmp_path):
    out = tmp_path / "bulb.png"
    ended = cutis("edit", maps, "--melanin", "x1.5", "--illuminant", "A", "-o", out)
    assert (ended.code, ended.err) == (0, "")
    assert "melanin x1.5\nshown under A\n768 texels changed" in ended.out
    face = package.read(maps.parents[1] / "face.png")
    expected = package.estimate(face).multiply(melanin=1.5).retouch(face, "A")
    np.testing.assert_array_equal(package.read(out).pixels, expected.pixels)


def test_an_unknown_light_is_refused_before_the_work(maps, cutis, one_line, tmp_path):
    ended = cutis("edit", maps, "--illuminant", "candle", "-o", tmp_path / "out.png")
    assert "unknown illuminant 'candle'" in one_line(ended)
    assert not (tmp_path / "out.png").exists()


def test_edited_maps_keep_their_sigma(trusting, write_face, cutis, tmp_path):
    face, skin, again = (tmp_path / n for n in ("face.png", "face.skin.exr", "again.skin.exr"))
    write_face(tmp_path)
    package.estimate(package.read(face)).save(skin)
    ended = cutis("edit", skin, "--source", face, "--melanin", "x1.5", "--blood", "0.02",
                  "--save-maps", again, "-o", tmp_path / "out.png")  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    before, after = load_maps(skin), load_maps(again)
    np.testing.assert_allclose(after.sigma("melanin"), 1.5 * before.sigma("melanin"), rtol=1e-3)
    assert after.sigma("blood").max() == 0
    np.testing.assert_array_equal(after.sigma("thickness"), before.sigma("thickness"))
    np.testing.assert_array_equal(after.confidence, before.confidence)


@pytest.mark.parametrize("kind", ["png8", "png16", "tiff16", "exr"])
@pytest.mark.parametrize("alpha", [False, True], ids=["RGB", "RGBA"])
def test_identity_is_bit_for_bit(kind, alpha, write_face, cutis, tmp_path):
    face = write_face(tmp_path, kind, alpha)
    skin, out = tmp_path / "face.skin.exr", tmp_path / f"same{face.suffix}"
    package.estimate(package.read(face)).save(skin)
    ended = cutis("edit", skin, "--source", face, "--melanin", "x1", "-o", out)
    assert (ended.code, ended.err) == (0, "")
    assert f"0 texels changed; wrote {out}" in ended.out
    before, after = package.read(face), package.read(out)
    assert (after.pixels.dtype, after.channels) == (before.pixels.dtype, before.channels)
    np.testing.assert_array_equal(after.pixels, before.pixels)


def test_flags_are_edits_after_presets(maps, cutis, tmp_path):
    out = tmp_path / "tanned.png"
    ended = cutis(
        "edit", maps, "--preset", "tanning", "--preset", "blood-half", "--thickness", "-10",
        "--blood", "+0.001", "--oxygenation", "0.9", "-o", out,
    )  # fmt: skip
    assert (ended.code, ended.err) == (0, "")
    face = package.read(maps.parents[1] / "face.png")
    edited = package.estimate(face).apply(presets.tanning).apply(presets.blood_half)
    edited = edited.offset(thickness=-10).offset(blood=0.001).replace(oxygenation=0.9)
    np.testing.assert_array_equal(package.read(out).pixels, edited.retouch(face).pixels)
    lines = [line.split(",")[0] for line in ended.out.splitlines()]
    assert lines[:-1] == [text.split(",")[0] for text in edited.edits]


def test_clamped_texels_are_announced(maps, cutis, tmp_path):
    ended = cutis("edit", maps, "--melanin", "x1e6", "-o", tmp_path / "dark.png")
    assert (
        "melanin x1e+06, 768 texels clamped to range (100.0\N{NO-BREAK SPACE}% of the mask)"
        in ended.out
    )


def test_painted_mask_and_amount(maps, cutis, tmp_path):
    from PIL import Image

    paint = np.zeros((24, 32), np.uint8)
    paint[:, 16:] = 255
    Image.fromarray(paint).save(tmp_path / "paint.png")
    out = tmp_path / "half.png"
    ended = cutis(
        "edit", maps, "--melanin", "x3", "--amount", "0.5", "--mask", tmp_path / "paint.png",
        "-o", out,
    )  # fmt: skip
    assert ended.code == 0, ended.err
    face = package.read(maps.parents[1] / "face.png")
    edited = package.estimate(face).multiply(melanin=2, where=paint / 255)
    np.testing.assert_array_equal(package.read(out).pixels, edited.retouch(face).pixels)
    np.testing.assert_array_equal(package.read(out).pixels[:, :16], face.pixels[:, :16])


def test_quiet(maps, cutis, tmp_path):
    ended = cutis("edit", maps, "--melanin", "x2", "-o", tmp_path / "a.png", "-q")
    assert (ended.code, ended.out, ended.err) == (0, "", "")


def test_saved_maps_can_be_edited_again(maps, cutis, tmp_path):
    """From another folder, to the colours of both edits at once."""
    (tmp_path / "deep" / "er").mkdir(parents=True)
    tanned, once = tmp_path / "deep" / "er" / "tanned.exr", tmp_path / "once.png"
    first = cutis(
        "edit", maps, "--melanin", "x1.4", "--save-maps", tanned, "-o", tmp_path / "a.png"
    )
    assert first.code == 0, first.err
    skin = load_maps(tanned)
    assert skin.edits == ("melanin x1.4",)
    assert skin.provenance["source"] == "../../work/face.png"
    before = load_maps(maps)
    assert skin.provenance["source_sha256"] == before.provenance["source_sha256"]
    assert (skin.model, skin.calibration) == (before.model, before.calibration)

    twice = tmp_path / "twice.png"
    again = cutis("edit", tanned, "--blood", "x0.5", "-o", twice)
    assert (again.code, again.err) == (0, "")
    assert again.out.splitlines()[0] == "blood x0.5"  # edits of earlier runs are not said again
    assert cutis("edit", maps, "--melanin", "x1.4", "--blood", "x0.5", "-o", once).code == 0
    np.testing.assert_array_equal(package.read(twice).pixels, package.read(once).pixels)
    unchanged = cutis("edit", tanned, "-o", tmp_path / "b.png")
    assert unchanged.code == 0
    assert digest(tmp_path / "a.png") == digest(tmp_path / "b.png")


def test_rare_chromophores_are_kept_with_the_maps(maps, cutis, tmp_path):
    """By flag or preset, in saved maps, and in edits of those."""
    ill, again, once = tmp_path / "ill.exr", tmp_path / "again.png", tmp_path / "once.png"
    ended = cutis("edit", maps, "--preset", "jaundice", "--save-maps", ill, "-o", again)
    assert ended.out.splitlines()[0] == "jaundice: bilirubin 0.04"
    skin = load_maps(ill)
    assert skin.rare == ("bilirubin",)
    assert not skin.original.bilirubin.any()
    assert "bilirubin: 0.04 g/L" in cutis("info", ill).out
    cutis("edit", maps, "--bilirubin", "0.04", "-o", once)
    assert digest(again) == digest(once)
    cutis("edit", ill, "--methaemoglobin", "0.2", "--bilirubin", "x0.5", "-o", again)
    cutis("edit", maps, "--methaemoglobin", "0.2", "--bilirubin", "0.02", "-o", once)
    np.testing.assert_array_equal(package.read(again).pixels, package.read(once).pixels)
    unchanged = cutis("edit", maps, "--carotene", "0", "-o", once)
    assert "0 texels changed" in unchanged.out
    assert "outside its range" in cutis("edit", maps, "--carotene", "1", "-o", once).err


def test_the_capture_is_never_overwritten(maps, cutis, one_line, tmp_path):
    face = maps.parents[1] / "face.png"
    before = digest(face), digest(maps)
    (tmp_path / "link.png").symlink_to(face)
    for out in (face, face.parent / "out" / ".." / "face.png", tmp_path / "link.png"):
        assert "is the capture itself" in one_line(cutis("edit", maps, "--blood", "x2", "-o", out))
    new = tmp_path / "new.exr"
    line = one_line(cutis("edit", maps, "--blood", "x2", "-o", new, "--save-maps", face))
    assert "is the capture itself" in line
    assert "is the file of maps itself" in one_line(
        cutis("edit", maps, "--blood", "x2", "-o", maps)
    )
    line = one_line(cutis("edit", maps, "--blood", "x2", "-o", new, "--save-maps", new))
    assert "would be written twice" in line
    assert (digest(face), digest(maps)) == before
    assert not new.exists()


def test_a_capture_that_changed_or_went(maps, cutis, one_line, tmp_path):
    face, flags = maps.parents[1] / "face.png", ("--blood", "x2")
    out = tmp_path / "new.png"
    face.rename(tmp_path / "other.png")
    assert "is missing; give it with --source" in one_line(cutis("edit", maps, *flags, "-o", out))
    assert (
        cutis("edit", maps, *flags, "--source", tmp_path / "other.png", "-o", out, "-q").code == 0
    )
    face.write_bytes((tmp_path / "other.png").read_bytes() + b"\n")
    assert "has changed since" in one_line(cutis("edit", maps, *flags, "-o", tmp_path / "b.png"))
    assert not (tmp_path / "b.png").exists()


def test_maps_saved_from_python_find_their_capture(write_face, cutis, tmp_path):
    import cutis as package

    face = write_face(tmp_path)
    package.estimate(package.read(face)).save(tmp_path / "face.skin.exr")
    out = tmp_path / "same.png"
    assert cutis("edit", tmp_path / "face.skin.exr", "--melanin", "x1", "-o", out).code == 0
    assert (package.read(out).pixels == package.read(face).pixels).all()


def test_loaded_maps_come_with_their_capture(write_face, tmp_path):
    import cutis as package

    face = write_face(tmp_path)
    skin = package.estimate(package.read(face))
    skin.save(tmp_path / "face.skin.exr")
    again = package.load(tmp_path / "face.skin.exr")
    assert (again.multiply(melanin=2).albedo() == skin.multiply(melanin=2).albedo()).all()


def test_an_edit_of_nothing_is_refused(maps, cutis, one_line, tmp_path):
    out = tmp_path / "out.png"
    assert "there is nothing to do: give --preset" in one_line(cutis("edit", maps, "-o", out))
    assert not out.exists()
