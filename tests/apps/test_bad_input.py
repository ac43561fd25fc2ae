"""Every kind of bad input: a non-zero code, one clear line, and nothing left behind."""

import os
import struct
import sys
import zlib

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

import cutis as package
from cutis.colour import LINEAR
from cutis.textures import Texture


def write_exr(path, pixels):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float")
    sink = oiio.ImageOutput.create(str(path))
    assert sink.open(str(path), spec)
    assert sink.write_image(pixels)
    assert sink.close()
    return path


def truncated(folder, write_face):
    path = write_face(folder)
    path.write_bytes(path.read_bytes()[:-200])
    return path


def truncated_exr(folder, write_face):
    path = write_face(folder, "exr")
    path.write_bytes(path.read_bytes()[:-200])
    return path


def no_image(folder, write_face):
    (folder / "face.png").write_text("a letter about a face")
    return folder / "face.png"


def nothing(folder, write_face):
    (folder / "face.png").touch()
    return folder / "face.png"


def no_texels(folder, write_face):
    path = write_face(folder)
    data = bytearray(path.read_bytes())
    data[16:24] = struct.pack(">II", 0, 0)
    data[29:33] = struct.pack(">I", zlib.crc32(data[12:29]))
    path.write_bytes(data)
    return path


def by_pillow(mode, suffix):
    def write(folder, write_face):
        path = folder / f"face{suffix}"
        Image.new("RGB", (32, 24), (200, 140, 120)).convert(mode).save(path)
        return path

    return write


def with_value(value):
    def write(folder, write_face):
        pixels = np.full((24, 32, 3), 0.4, np.float32)
        pixels[3, 5, 1] = value
        return write_exr(folder / "face.exr", pixels)

    return write


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda folder, _: folder / "face.png", "no such file"),
        (lambda folder, _: folder, "there is no image in this folder"),
        (no_image, "is not a PNG, JPEG, TIFF, OpenEXR, DPX or PSD image"),
        (nothing, "is empty"),
        (no_texels, "has no texels"),
        (truncated, "truncated"),
        (truncated_exr, "damaged or truncated"),
        (by_pillow("L", ".png"), "is a grey image"),
        (by_pillow("CMYK", ".jpg"), "is CMYK"),
        (by_pillow("P", ".png"), "stores a palette"),
        (with_value(np.nan), "NaN or infinite, the first at row 3, column 5"),
        (with_value(-np.inf), "NaN or infinite"),
    ],
    ids=[
        "missing", "folder", "text", "empty", "zero size", "truncated", "truncated EXR",
        "one channel", "CMYK", "palette", "NaN", "infinite",
    ],
)  # fmt: skip
def test_captures(write, message, write_face, cutis, one_line, tmp_path):
    path = write(tmp_path, write_face)
    before = sorted(tmp_path.iterdir())
    line = one_line(cutis("estimate", path, "-o", tmp_path / "out"))
    assert message in line
    assert path.name in line
    assert sorted(tmp_path.iterdir()) == before


def grey(folder, values):
    path = folder / "mask.png"
    Image.fromarray(values.astype(np.uint8)).save(path)
    return path


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.full((24, 31), 255), "the mask has 31 × 24 texels, the texture 32 × 24"),
        (np.zeros((24, 32)), "the mask is empty"),
    ],
    ids=["other size", "empty"],
)
@pytest.mark.parametrize("command", ["estimate", "edit"])
def test_masks(command, values, message, maps, cutis, one_line, tmp_path):
    mask = grey(tmp_path, values)
    face = maps.parents[1] / "face.png"
    source = ["estimate", face] if command == "estimate" else ["edit", maps, "--melanin", "x2"]
    out = tmp_path / "new.png"
    line = one_line(cutis(*source, "--mask", mask, "-o", out))
    assert message in line
    assert "mask.png" in line
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--white", "sunny"], "--white takes none, auto or three gains"),
        (["--white", "1,1"], "--white takes none, auto or three gains"),
        (["--white", "1,1,99"], "white takes none, auto or three numbers"),
        (["--exposure", "bright"], "--exposure takes none, auto or one gain"),
        (["--exposure", "nan"], "exposure takes none, auto or one number"),
        (["--device", "gpu"], "unknown device"),
        (["--colorspace", "log"], "unknown colour space 'log'"),
        (["--model", "nobody"], "unknown model 'nobody'"),
    ],
)
def test_flags_of_estimate(arguments, message, write_face, cutis, one_line, tmp_path):
    face = write_face(tmp_path)
    out = tmp_path / "out"
    assert message in one_line(cutis("estimate", face, *arguments, "-o", out))
    assert not out.exists() or not list(out.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--preset", "sunbern"], "unknown preset 'sunbern'"),
        (["--melanin", "2"], "melanin = 2 is outside its range 0.001 to 1"),
        (["--thickness", "5"], "thickness = 5 is outside its range 10 to 250 µm"),
        (["--melanin", "dark"], "--melanin takes a value"),
        (["--melanin", "x-1"], "cannot multiply melanin by -1"),
        (["--melanin", "x2", "--amount", "1.5"], "--amount is a number from 0 to 1"),
        (["--melanin", "x2", "--source", "nowhere.png"], "nowhere.png"),
    ],
)
def test_flags_of_edit(arguments, message, maps, cutis, one_line, tmp_path):
    out = tmp_path / "new.png"
    assert message in one_line(cutis("edit", maps, *arguments, "-o", out))
    assert not out.exists()


def test_an_extension_that_is_no_format(maps, cutis, one_line, tmp_path):
    line = one_line(cutis("edit", maps, "--melanin", "x2", "-o", tmp_path / "tanned.psd"))
    assert "none of .png, .jpg" in line
    assert not (tmp_path / "tanned.psd").exists()


@pytest.mark.parametrize("command", ["edit", "info"])
def test_maps_that_are_none(command, write_face, cutis, one_line, tmp_path):
    more = ["-o", tmp_path / "new.png"] if command == "edit" else []
    exr, png = write_face(tmp_path, "exr"), write_face(tmp_path)
    assert "not a file of skin maps" in one_line(cutis(command, exr, *more))
    assert "cutis estimate" in one_line(cutis(command, png, *more))
    assert "no such file" in one_line(cutis(command, tmp_path / "none.exr", *more))


def test_output_folder_is_a_file(write_face, cutis, one_line, tmp_path):
    face = write_face(tmp_path)
    (tmp_path / "out").write_text("mine")
    assert "cannot make this folder" in one_line(cutis("estimate", face, "-o", tmp_path / "out"))
    assert (tmp_path / "out").read_text() == "mine"


def test_output_in_no_folder(maps, cutis, one_line, tmp_path):
    out = tmp_path / "nowhere" / "new.png"
    assert "does not exist; create it" in one_line(cutis("edit", maps, "--blood", "x2", "-o", out))
    assert "does not exist" in one_line(cutis("spectrum", "-o", out.with_suffix(".csv")))


# Root may write anywhere; on Linux a process can give that up.
AS_ANYONE = (
    "import ctypes, os\n"
    "if os.geteuid() == 0:\n"
    "    version, none = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()\n"
    "    assert ctypes.CDLL(None).capset(version, none) == 0\n"
)


@pytest.mark.skipif(sys.platform != "linux", reason="rights of Linux")
@pytest.mark.parametrize("command", ["estimate", "edit", "spectrum", "train"])
def test_a_folder_without_write_access(command, maps, process, one_line, tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    arguments = {
        "estimate": ["estimate", maps.parents[1] / "face.png", "-o", locked],
        "edit": ["edit", maps, "--blood", "x2", "-o", locked / "new.png"],
        "spectrum": ["spectrum", "-o", locked / "skin.csv"],
        "train": ["train", "aliaga2022-exact", "-o", locked / "run"],
    }
    assert "permission denied" in one_line(process(*arguments[command], before=AS_ANYONE))
    assert list(locked.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
@pytest.mark.parametrize("command", ["estimate", "edit", "spectrum"])
def test_a_full_disk(command, maps, process, one_line, tmp_path):
    """A limit on the size of files makes writes fail as a full disk does."""
    out = tmp_path / "out"
    out.mkdir()
    arguments = {
        "estimate": ["estimate", maps.parents[1] / "face.png", "-o", out],
        "edit": ["edit", maps, "--blood", "x2", "-o", out / "new.png"],
        "spectrum": ["spectrum", "-o", out / "skin.csv"],
    }
    before = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (400, 400))"
    ended = process(*arguments[command], before=before)
    assert "cannot be written" in one_line(ended)
    assert list(out.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "needs a header"),
        ("name\nanna\n", "needs a header with some of melanin"),
        ("melanin\n", "needs a header"),
        ("melanin,blood\n0.1\n", "skin 1: 1 cells under 2 columns"),
        ("melanin\n0.1\n7\n", "skin 2: melanin = 7 is outside its range"),
        ("melanin\ndark\n", "skin 1: could not convert"),
        ("melanin\nnan\n", "skin 1: melanin = nan is outside"),
        (b"melanin\n\xff\xfe\n", "is no CSV file in UTF-8"),
    ],
)
def test_tables_of_skins(text, message, cutis, one_line, tmp_path):
    path = tmp_path / "skins.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    line = one_line(cutis("spectrum", path, "-o", tmp_path / "out.csv"))
    assert message in line
    assert "skins.csv" in line
    assert [p.name for p in tmp_path.iterdir()] == ["skins.csv"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--melanin", "2"], "outside its range"),
        (["--oxygenation", "nan"], "outside its range"),
        (["none.csv"], "no such file"),
        (["none.csv", "--melanin", "0.1"], "either a CSV of skins or parameter flags"),
        (["-o", "skin.png"], "end its name in .csv"),
    ],
)
def test_flags_of_spectrum(arguments, message, cutis, one_line):
    assert message in one_line(cutis("spectrum", *arguments))


def test_unknown_recipes(cutis, one_line, tmp_path):
    line = one_line(cutis("train", "mystery", "-o", tmp_path / "run"))
    assert "unknown recipe 'mystery'; known are " in line
    for name in ("measured2026", "measured2026b", "aliaga2022-exact", "aliaga2022"):
        assert name in line
    assert not (tmp_path / "run").exists()


def test_colours_that_are_no_albedo_are_announced(face_rgb, cutis, tmp_path):
    import json

    pixels = face_rgb.copy()
    pixels[2, 3] = (-0.01, 0.3, 0.2)
    pixels[5, :2] = (1.5, 0.9, 0.8)
    package.write(Texture(pixels, ("R", "G", "B"), LINEAR), tmp_path / "face.exr")
    ended = cutis("estimate", tmp_path / "face.exr", "-o", tmp_path / "out")
    assert ended.code == 0, ended.err
    lines = ended.out.splitlines()
    assert "1 texels have a colour negative, which is no albedo" in lines
    assert "2 texels have a colour above one, which is no albedo" in lines
    report = json.loads((tmp_path / "out" / "face.report.json").read_text("utf-8"))
    assert (report["below_0"], report["above_1"]) == (1, 2)
