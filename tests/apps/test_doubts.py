"""Input that is no albedo gets no praise: `cutis estimate` says what is wrong and how to go on."""

import json

import numpy as np
import pytest

from cutis.colour import LINEAR, SRGB, encode_srgb
from cutis.textures import Texture, read_mask, read_texture, write_texture


@pytest.fixture(scope="module")
def face(capture1):
    """The example capture in a quarter of its size: linear sRGB and mask."""
    texture = read_texture(capture1[0])
    mask = read_mask(capture1[1], texture.frame)
    return texture.linear()[::4, ::4], (mask[::4, ::4] > 0.5).astype(np.float32)


def written(path, rgb, space=SRGB, dtype=np.uint8):
    blank = Texture(np.zeros(rgb.shape, dtype), ("R", "G", "B"), space)
    write_texture(blank.with_linear(rgb, np.ones(rgb.shape[:2], bool)), path, space)
    return path


def as_mask(path, mask):
    return written(path, np.repeat(mask[..., None], 3, axis=-1).astype(np.float32))


def shaded(rgb):
    """A photograph: light from one side, and a highlight."""
    height, width = rgb.shape[:2]
    y, x = np.mgrid[:height, :width]
    light = 1.1 - 0.9 * x / width
    shine = 0.5 * np.exp(-((y - 0.4 * height) ** 2 + (x - 0.4 * width) ** 2) / (0.05 * width) ** 2)
    return np.float32(rgb * light[..., None] + shine[..., None]).clip(0, 1)


def estimated(cutis, folder, face, mask, kind):
    more = () if mask is None else ("--mask", mask)
    ended = cutis("estimate", face, "-o", folder / "out", "--report", *more)
    assert (ended.code, ended.err) == (0, "")
    told = json.loads((folder / "out" / f"{face.stem}.report.json").read_text("utf-8"))
    assert kind in {one["kind"] for one in told["doubts"]}
    assert all(one["hint"] for one in told["doubts"])
    assert f"doubtful input ({kind})" in ended.out
    page = (folder / "out" / f"{face.stem}.report.html").read_text("utf-8")
    for text in (ended.out, page):
        assert "well known" not in text
        assert "roughly known" not in text
    assert "may be no albedo of skin" in page


def test_a_shaded_photograph_with_a_highlight(cutis, face, tmp_path):
    rgb, mask = face
    path = written(tmp_path / "photo.png", shaded(rgb))
    estimated(cutis, tmp_path, path, as_mask(tmp_path / "m.png", mask), "baked-light")


def test_an_inverted_mask(cutis, face, tmp_path):
    rgb, mask = face
    path = written(tmp_path / "face.png", rgb)
    estimated(cutis, tmp_path, path, as_mask(tmp_path / "m.png", 1 - mask), "mask-inverted")


def test_floats_from_0_to_255(cutis, face, tmp_path):
    rgb, mask = face
    codes = np.rint(255 * encode_srgb(rgb)).astype(np.float32)
    path = written(tmp_path / "codes.exr", codes, LINEAR, np.float32)
    estimated(cutis, tmp_path, path, as_mask(tmp_path / "m.png", mask), "scale")


def test_one_texel(cutis, face, tmp_path):
    path = written(tmp_path / "dot.png", np.full((1, 1, 3), (0.4, 0.25, 0.2), np.float32))
    estimated(cutis, tmp_path, path, None, "size")


def test_an_albedo_is_praised(cutis, face, tmp_path):
    rgb, mask = face
    path = written(tmp_path / "face.png", rgb)
    ended = cutis(
        "estimate", path, "-o", tmp_path / "out", "--mask", as_mask(tmp_path / "m.png", mask)
    )
    assert "doubtful" not in ended.out
    assert "well known" in ended.out
