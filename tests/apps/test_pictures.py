"""Captures, masks and outputs as viewers show them: orientation, windows, alpha, thumbnails."""

import io
import json

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image, ImageOps

from cutis.textures import read_channels

TURN = {2: "FLIP_LEFT_RIGHT", 3: "ROTATE_180", 6: "ROTATE_90", 8: "ROTATE_270"}  # there and back


@pytest.fixture
def face(face_rgb):
    """(24, 32, 3) uint8, encoded."""
    from cutis.colour import encode_srgb

    return np.rint(encode_srgb(face_rgb).clip(0, 1) * 255).astype(np.uint8)


def saved(path, picture, orientation=None, **how):
    """A picture that viewers show as it is, stored as `orientation` says."""
    image = Image.fromarray(picture)
    if orientation is not None:
        image = image.transpose(Image.Transpose[TURN[orientation]])
        tags = Image.Exif()
        tags[274] = orientation
        how["exif"] = tags
    held = io.BytesIO()
    image.save(held, {".jpg": "JPEG", ".png": "PNG", ".tif": "TIFF"}[path.suffix], **how)
    path.write_bytes(held.getvalue())
    return path


def shown(path):
    return np.asarray(ImageOps.exif_transpose(Image.open(path)))


def maps(path):
    return read_channels(path)[0]


def painted(path, shape, rows, columns):
    mask = np.zeros(shape, np.uint8)
    mask[rows, columns] = 255
    Image.fromarray(mask).save(path)
    return path


@pytest.mark.parametrize("orientation", TURN)
@pytest.mark.parametrize("kind", ["png", "tif"])
def test_a_capture_that_is_stored_turned(cutis, tmp_path, face, orientation, kind):
    """Maps, mask and edit are those of the same picture stored upright."""
    one = saved(tmp_path / f"turned.{kind}", face, orientation)
    other = saved(tmp_path / f"upright.{kind}", face)
    mask = painted(tmp_path / "m.png", face.shape[:2], slice(0, 8), slice(4, 20))
    for path in (one, other):
        ended = cutis("estimate", path, "--mask", mask, "-o", tmp_path / "out")
        assert ended.code == 0, ended.err
        assert ("as its orientation tag" in ended.out) == (path == one)
    found, wanted = (maps(tmp_path / "out" / f"{n}.skin.exr") for n in ("turned", "upright"))
    for name in ("melanin", "blood", "mask"):
        np.testing.assert_array_equal(found[name], wanted[name])
    notes = json.loads((tmp_path / "out" / "turned.report.json").read_text())["notes"]
    assert any(f"orientation tag ({orientation})" in note for note in notes)
    spot = painted(tmp_path / "spot.png", face.shape[:2], slice(2, 5), slice(6, 9))
    flags = ("--melanin", "x2", "--mask", spot)
    for name in ("turned", "upright"):
        out = tmp_path / f"{name}-edited.{kind}"
        assert cutis("edit", tmp_path / "out" / f"{name}.skin.exr", *flags, "-o", out).code == 0
    edited = shown(tmp_path / f"turned-edited.{kind}")
    assert np.array_equal(edited, shown(tmp_path / f"upright-edited.{kind}"))
    assert np.array_equal((edited != face).any(-1), np.asarray(Image.open(spot)) > 0)


def test_a_tag_that_is_wrong_is_ignored_from_end_to_end(cutis, tmp_path, face):
    path = saved(tmp_path / "a.png", face, 3)
    stored = oiio.ImageBuf(str(path)).get_pixels("uint8")
    saved(tmp_path / "b.png", stored)
    mask = painted(tmp_path / "m.png", face.shape[:2], slice(0, 8), slice(4, 20))
    ended = cutis(
        "estimate", path, "--orientation", "ignore", "--mask", mask, "-o", tmp_path / "out"
    )
    assert "its orientation tag (3) is ignored, as asked for" in ended.out
    cutis("estimate", tmp_path / "b.png", "--mask", mask, "-o", tmp_path / "out")
    for name in "ab":
        out = tmp_path / f"{name}-edited.png"
        cutis("edit", tmp_path / "out" / f"{name}.skin.exr", "--melanin", "x2", "-o", out)
    one, other = (oiio.ImageBuf(str(tmp_path / f"{n}-edited.png")) for n in "ab")
    assert np.array_equal(one.get_pixels("uint8"), other.get_pixels("uint8"))
    assert one.spec().get_int_attribute("Orientation") == 3  # as it came


def test_maps_from_before_orientation_counted(cutis, tmp_path, face, write_face):
    """Version 0.1 took texels as they are stored, and did not say so."""
    from cutis.maps.source import orientation_of

    path = saved(tmp_path / "a.png", face, 6)
    cutis("estimate", path, "--orientation", "ignore", "-o", tmp_path)
    old = tmp_path / "a.skin.exr"
    content = old.read_bytes()
    assert b"cutis:source_orientation" in content
    old.write_bytes(content.replace(b"cutis:source_orientation", b"cutis:somebodys_own_note"))
    assert cutis("edit", old, "--melanin", "x2", "-o", tmp_path / "b.png").code == 0
    assert orientation_of({}) == "auto"
    assert orientation_of({"source": "a.png"}) == "ignore"


def exr(path, values, corner, display):
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], 3, "float")
    spec.x, spec.y = corner
    spec.full_x = spec.full_y = 0
    spec.full_width, spec.full_height = display
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec)
    assert out.write_image(np.ascontiguousarray(values))
    assert out.close()
    return path


@pytest.mark.parametrize(
    ("corner", "display"),
    [((-4, -3), (24, 18)), ((10, 5), (50, 40)), ((-6, 9), (20, 30)), ((0, 0), (32, 24))],
)
def test_windows_go_through(cutis, tmp_path, face_rgb, corner, display):
    """A mask painted on the display is placed; maps keep windows; a PNG holds the display."""
    exr(tmp_path / "a.exr", face_rgb, corner, display)
    mask = painted(tmp_path / "m.png", display[::-1], slice(4, 16), slice(2, 18))
    out = tmp_path / "out"
    ended = cutis("estimate", tmp_path / "a.exr", "--mask", mask, "-o", out)
    assert ended.code == 0, ended.err
    wanted = (*corner, 32, 24, 0, 0, *display)
    for name in ("a.skin.exr", "a.model.exr"):
        spec = oiio.ImageInput.open(str(out / name)).spec()
        found = (spec.x, spec.y, spec.width, spec.height,
                 spec.full_x, spec.full_y, spec.full_width, spec.full_height)  # fmt: skip
        assert found == wanted
    on_mask = np.asarray(Image.open(mask)) > 0
    cover = maps(out / "a.skin.exr")["mask"]
    for row in range(24):
        for column in range(32):
            y, x = row + corner[1], column + corner[0]
            inside = 0 <= y < display[1] and 0 <= x < display[0]
            assert cover[row, column] == (inside and on_mask[y, x])
    flags = ("--melanin", "x2", "--mask", mask, "--save-maps", tmp_path / "b.skin.exr")
    assert cutis("edit", out / "a.skin.exr", *flags, "-o", tmp_path / "b.png").code == 0
    assert np.asarray(Image.open(tmp_path / "b.png")).shape[1::-1] == display
    spec = oiio.ImageInput.open(str(tmp_path / "b.skin.exr")).spec()
    assert (spec.x, spec.y, spec.full_width, spec.full_height) == (*corner, *display)
    assert cutis("edit", out / "a.skin.exr", "--melanin", "x2", "-o", tmp_path / "b.exr").code == 0
    spec = oiio.ImageInput.open(str(tmp_path / "b.exr")).spec()
    assert (spec.x, spec.y, spec.full_width, spec.full_height) == (*corner, *display)


def test_windows_in_memory_too(tmp_path, face_rgb):
    import cutis

    path = exr(tmp_path / "a.exr", face_rgb, (10, 5), (50, 40))
    cutis.estimate(cutis.read(path)).save(tmp_path / "a.skin.exr")
    spec = oiio.ImageInput.open(str(tmp_path / "a.skin.exr")).spec()
    assert (spec.x, spec.y, spec.full_width, spec.full_height) == (10, 5, 50, 40)
    cutis.load(tmp_path / "a.skin.exr").multiply(melanin=2).save(tmp_path / "b.skin.exr")
    spec = oiio.ImageInput.open(str(tmp_path / "b.skin.exr")).spec()
    assert (spec.x, spec.y, spec.full_width, spec.full_height) == (10, 5, 50, 40)


@pytest.mark.parametrize("mode", ["RGBA", "LA"])
def test_a_mask_in_alpha(cutis, tmp_path, face, mode):
    saved(tmp_path / "a.png", face)
    planes = np.full((24, 32, len(mode)), 255, np.uint8)
    planes[..., -1] = 0
    planes[4:12, 5:20, -1] = 255
    Image.fromarray(planes).save(tmp_path / "m.png")
    ended = cutis("estimate", tmp_path / "a.png", "--mask", tmp_path / "m.png", "-o", tmp_path)
    assert "the mask is in its alpha channel" in ended.out
    assert np.array_equal(maps(tmp_path / "a.skin.exr")["mask"], planes[..., -1] / 255)


def test_regions_with_a_palette_and_with_crumbs(cutis, one_line, tmp_path, face):
    saved(tmp_path / "a.png", face)
    numbers = np.zeros((24, 32), np.uint8)
    numbers[:12], numbers[12:], numbers[20, 20] = 1, 2, 3
    picture = Image.fromarray(numbers, "P")
    picture.putpalette([0, 0, 0, 255, 0, 0, 0, 255, 0, 255, 255, 0])
    picture.save(tmp_path / "r.png")
    ended = cutis("estimate", tmp_path / "a.png", "--regions", tmp_path / "r.png", "-o", tmp_path)
    assert "1 of 3 regions have less than 0.2 % of the texels" in ended.out
    report = json.loads((tmp_path / "a.report.json").read_text())
    assert [region["name"] for region in report["regions"]] == ["#00ff00", "#ff0000", "#ffff00"]
    picture.convert("RGB").save(tmp_path / "r.jpg")
    message = one_line(
        cutis("estimate", tmp_path / "a.png", "--regions", tmp_path / "r.jpg", "-o", tmp_path / "b")
    )
    assert "r.jpg: is packed lossily" in message


def test_the_pictures_that_are_left_out_are_named(cutis, tmp_path, face):
    first = Image.fromarray(face[::4, ::4].copy())
    first.save(
        tmp_path / "a.tif", save_all=True, append_images=[Image.fromarray(face)],
        tiffinfo={254: 1},
    )  # fmt: skip
    ended = cutis("estimate", tmp_path / "a.tif", "-o", tmp_path)
    assert "page 2 (32 × 24) is read and edited; page 1 (8 × 6) is left out" in ended.out
    assert maps(tmp_path / "a.skin.exr")["blood"].shape == (24, 32)
    ended = cutis("edit", tmp_path / "a.skin.exr", "--melanin", "x2", "-o", tmp_path / "b.tif")
    assert "page 1 (8 × 6) is left out" in ended.out


def test_people_numbered_by_a_camera_are_no_tiles(cutis, tmp_path, face):
    folder = tmp_path / "people"
    folder.mkdir()
    for number, gain in ((1234, 1.0), (1235, 1.2), (1240, 0.8)):
        saved(folder / f"IMG_{number}.png", (face * gain).clip(0, 255).astype(np.uint8))
    ended = cutis("estimate", folder, "--white", "auto", "-o", tmp_path / "out")
    assert "taken for separate captures, not for tiles of one texture" in ended.out
    gains = set()
    for number in (1234, 1235, 1240):
        report = json.loads((tmp_path / "out" / f"IMG_{number}.report.json").read_text())
        gains.add(tuple(report["calibration"]["gains"]))
    assert len(gains) == 3


@pytest.mark.parametrize("kind", ["device", "pipe"])
def test_outputs_that_are_no_files_stay_what_they_are(cutis, one_line, tmp_path, kind):
    import os

    out = tmp_path / "out.csv"
    if kind == "pipe":
        os.mkfifo(out)
    else:
        out.symlink_to("/dev/null")
    message = one_line(cutis("spectrum", "--melanin", "0.02", "-o", out))
    assert f"is a {kind}" in message
    assert not out.is_file()
    assert out.exists()


def test_a_name_that_is_too_long_is_known_before_any_work(cutis, one_line, tmp_path, face):
    """Results have longer names than captures."""
    for letter, count in (("a", 240), ("ä", 121)):
        path = saved(tmp_path / f"{letter * count}.png", face)
        message = one_line(cutis("estimate", path, "-o", tmp_path / "out"))
        assert "its name is longer than 255 bytes; choose a shorter one" in message
        assert not (tmp_path / "out").exists()


def test_formulas_of_a_stranger_are_text(cutis, tmp_path):
    path = tmp_path / "skins.csv"
    path.write_text("note,melanin\n=cmd|x,0.02\n# 2,0.03\n-0.5,0.04\n")
    lines = cutis("spectrum", path).out.splitlines()
    assert [line.split(",")[0] for line in lines] == ["note", "'=cmd|x", "# 2", "-0.5"]
