"""Faults made on purpose are found; heads as they are have none."""

import numpy as np
import pytest

from cutis.colour import LINEAR, encode_srgb
from cutis.colour.transfer import decode_srgb
from tests.checks.conftest import HEADS, kinds


@pytest.mark.parametrize("tone", HEADS)
def test_heads_as_they_are_have_no_finding(heads, look, tone):
    assert kinds(look(*heads[tone])) == set()


def test_the_example_capture_has_no_finding(capture1, look):
    from cutis.textures import TextureFile, read_mask

    path, mask = capture1
    with TextureFile(path) as texture:
        assert kinds(look.at(path, read_mask(mask, texture.frame))) == set()


@pytest.mark.parametrize("tone", HEADS)
def test_codes_stored_as_linear_floats_are_told_by_their_steps(heads, look, tone):
    rgb, mask = heads[tone]
    codes = np.rint(255 * encode_srgb(rgb)).astype(np.float32) / 255
    for dtype in (np.float16, np.float32):
        found = look(codes, mask, ".exr", dtype, LINEAR)
        assert kinds(found) == {"colour-space"}
        assert "sRGB" in found.findings[0].hint
    right = look(rgb, mask, ".exr", np.float16, LINEAR)
    assert kinds(right) == set()


def test_light_skin_stored_encoded_is_too_grey_for_linear(heads, look):
    rgb, mask = heads["light"]
    smooth = (rgb[::2, ::2] + rgb[1::2, 1::2]) / 2  # off the steps of 8 bits
    found = look(encode_srgb(smooth).astype(np.float32), mask[::2, ::2], ".exr", np.float32, LINEAR)
    assert kinds(found) == {"colour-space"}
    assert found.findings[0].numbers["as_sRGB"] > 0.9 > 0.1 > found.findings[0].numbers["as_linear"]


@pytest.mark.parametrize("tone", ["light", "dark"])
def test_linear_values_read_as_srgb(heads, look, tone):
    rgb, mask = heads[tone]
    assert "colour-space" in kinds(look(decode_srgb(rgb).astype(np.float32), mask, dtype=np.uint16))


@pytest.mark.parametrize("tone", HEADS)
def test_floats_from_0_to_255(heads, look, tone):
    rgb, mask = heads[tone]
    found = look((255 * encode_srgb(rgb)).astype(np.float32), mask, ".exr", np.float32, LINEAR)
    assert kinds(found) == {"scale"}
    assert "Divide by 255" in found.findings[0].hint


@pytest.mark.parametrize("tone", HEADS)
def test_highlights(heads, look, tone):
    rgb, mask = heads[tone]
    height, width = mask.shape
    y, x = np.mgrid[:height, :width] / width
    shine = np.zeros(mask.shape, np.float32)
    for row, column in ((0.55, 0.5), (0.65, 0.45), (0.65, 0.55)):
        shine += np.exp(-((y - row * height / width) ** 2 + (x - column) ** 2) / (2 * 0.03**2))
    assert "gloss" in kinds(look((rgb + 0.4 * shine[..., None]).astype(np.float32), mask))


def test_a_balance_that_no_skin_has(heads, look):
    rgb, mask = heads["light"]
    for gains, what in (((0.7, 1, 1.3), "cold"), ((0.95, 1.2, 0.95), "green")):
        found = look((rgb * np.float32(gains)).clip(0, 1), mask)
        assert kinds(found) == {"cast"}
        assert what in found.findings[0].sentence


def test_far_too_bright_and_far_too_dark(heads, look):
    rgb, mask = heads["light"]
    assert "exposure" in kinds(look((1.8 * rgb).clip(0, 1), mask))
    dark = kinds(look(0.04 * rgb, mask, dtype=np.uint16))
    assert dark in ({"exposure"}, {"colour-space"})  # as dark as light read twice


def test_light_from_one_side(heads, look):
    rgb, mask = heads["light"]
    slope = np.linspace(1, 0.5, mask.shape[1], dtype=np.float32)[None, :, None]
    assert kinds(look(rgb * slope, mask)) == {"baked-light"}


def test_an_inverted_mask(heads, look):
    rgb, mask = heads["brown"]
    assert kinds(look(rgb, 1 - mask)) == {"mask-inverted"}


def test_a_swatch_and_a_single_texel(look):
    colour = np.full((64, 64, 3), (0.4, 0.25, 0.2), np.float32)
    assert kinds(look(colour)) == {"flat"}
    assert kinds(look(colour[:1, :1])) == {"size"}


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_all_black_and_all_white_end_in_findings(look, value):
    assert kinds(look(np.full((64, 64, 3), value, np.float32)))
    rng = np.random.default_rng(0)
    speckled = np.float32(value * np.ones((64, 64, 3)))
    speckled[rng.random((64, 64)) < 0.002] = 0.5
    assert kinds(look(speckled))


def test_clipped_and_crushed(heads, look):
    rgb, mask = heads["light"]
    assert "clipped" in kinds(look((2.6 * rgb).clip(0, 1), mask))
    assert "crushed" in kinds(look((rgb - 0.28).clip(0, 1), mask))


def test_few_codes(heads, look):
    rgb, mask = heads["light"]
    few = np.rint(encode_srgb(rgb) * 48) / 48
    assert "banding" in kinds(look(decode_srgb(few).astype(np.float32), mask))


@pytest.mark.parametrize("tone", ["light", "brown"])
def test_jpeg_of_low_quality(heads, tmp_path, look, tone):
    from PIL import Image

    rgb, mask = heads[tone]
    codes = np.uint8(np.rint(255 * encode_srgb(rgb).clip(0, 1)))
    Image.fromarray(codes).save(tmp_path / "low.jpg", quality=20)
    assert "jpeg-blocks" in kinds(look.at(tmp_path / "low.jpg", mask))


def test_what_is_no_skin(look):
    rng = np.random.default_rng(3)
    sky = np.float32([0.1, 0.3, 0.6]) * (1 + 0.1 * rng.standard_normal((200, 200, 1)))
    assert "not-skin" in kinds(look(sky.astype(np.float32)))


def test_the_tone_of_a_face(heads, look):
    tones = {name: look(*heads[name]).tone for name in HEADS}
    assert tones["light"].ita[1] > tones["brown"].ita[1] > tones["dark"].ita[1]
    assert tones["light"].monk[1] < tones["dark"].monk[1]
    low, middle, high = tones["light"].ita
    assert low < middle < high
