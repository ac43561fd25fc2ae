import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutis.colour import LINEAR, SRGB
from cutis.errors import CutisError
from cutis.textures import Texture
from cutis.textures.texture import bands, colour_channels


def texture(pixels, encoding=SRGB, channels=None, **more):
    names = channels or ("R", "G", "B", "A")[: pixels.shape[2]]
    return Texture(pixels, tuple(names), encoding, **more)


def everywhere(pixels, value=True):
    return np.full(pixels.shape[:2], value)


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize("encoding", [SRGB, LINEAR])
def test_every_integer_code_comes_back(dtype, encoding):
    codes = np.arange(np.iinfo(dtype).max + 1, dtype=dtype)
    pixels = np.stack([codes, codes[::-1], codes], -1)[:, None]
    one = texture(pixels, encoding)
    again = one.with_linear(one.linear(), everywhere(pixels))
    assert np.array_equal(again.pixels, pixels)
    assert again.pixels.dtype == dtype


def test_linear_is_the_standard_curve():
    codes = np.array([0, 1, 10, 11, 128, 255], np.uint8)
    x = codes / 255
    expected = np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)
    got = texture(np.stack([codes] * 3, -1)[None]).linear()
    assert got.dtype == np.float32
    np.testing.assert_allclose(got[0, :, 1], expected, rtol=1e-6)


def test_integers_round_to_nearest_and_clamp():
    one = texture(np.zeros((1, 4, 3), np.uint8), LINEAR)
    values = np.array([-1, 0.4 / 255, 0.6 / 255, 7])
    new = one.with_linear(np.stack([values] * 3, -1)[None], np.ones((1, 4), bool))
    assert new.pixels[0, :, 0].tolist() == [0, 0, 1, 255]


def test_half_clamps_to_its_range():
    one = texture(np.zeros((1, 1, 3), np.float16), LINEAR)
    new = one.with_linear(np.array([[[1e6, -1e6, 0.5]]]), np.ones((1, 1), bool))
    assert new.pixels[0, 0].tolist() == [65504, -65504, 0.5]


@given(
    seed=st.integers(0, 2**32 - 1),
    dtype=st.sampled_from(["uint8", "uint16", "float16", "float32"]),
    associated=st.booleans(),
)
@settings(max_examples=40, deadline=None)
def test_only_chosen_texels_change(seed, dtype, associated):
    random = np.random.default_rng(seed)
    pixels = (random.random((7, 9, 5)) * (255 if dtype[0] == "u" else 1)).astype(dtype)
    one = texture(pixels, SRGB, ("Z", "b", "A", "g", "r"), associated=associated)
    where = random.random((7, 9)) < 0.4
    new = one.with_linear(np.full((7, 9, 3), 0.25, np.float32), where)
    assert new.pixels[~where].tobytes() == pixels[~where].tobytes()
    assert new.pixels[..., [0, 2]].tobytes() == pixels[..., [0, 2]].tobytes()
    if not associated:
        np.testing.assert_allclose(new.linear()[where], 0.25, atol=0.004)


def test_associated_alpha_is_divided_out_and_back(random):
    alpha = np.array([0, 0.25, 0.5, 1], np.float32)[None]
    colour = random.random((1, 4, 3)).astype(np.float32)
    stored = np.concatenate([colour * alpha[..., None], alpha[..., None]], -1)
    stored[0, 0, :3] = 0.3  # light without cover stays
    one = texture(stored, LINEAR, associated=True)
    np.testing.assert_allclose(one.linear()[0, 1:], colour[0, 1:], rtol=1e-6)
    assert one.linear()[0, 0].tolist() == stored[0, 0, :3].tolist()
    again = one.with_linear(one.linear(), everywhere(stored))
    np.testing.assert_allclose(again.pixels, stored, rtol=1e-6)
    assert np.array_equal(again.pixels[0, [0, 3]], stored[0, [0, 3]])
    assert np.array_equal(one.alpha(), alpha)


def test_associated_integers_divide_encoded_values():
    one = texture(np.array([[[64, 32, 0, 128]]], np.uint8), associated=True)
    straight = texture(np.array([[[127.5, 63.75, 0]]], np.float32) / np.float32(255))
    np.testing.assert_allclose(one.linear(), straight.linear(), rtol=1e-6)


def test_no_alpha_is_none():
    assert texture(np.zeros((2, 2, 3), np.uint8)).alpha() is None


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_new_colours_must_be_finite_where_stored(bad):
    one = texture(np.zeros((2, 2, 3), np.float32), LINEAR)
    colour = np.zeros((2, 2, 3))
    colour[1, 1] = bad
    where = np.ones((2, 2), bool)
    with pytest.raises(CutisError, match="NaN or infinite"):
        one.with_linear(colour, where)
    where[1, 1] = False
    assert not one.with_linear(colour, where).pixels.any()


@pytest.mark.parametrize(
    ("shape", "where"),
    [
        ((2, 3, 3), np.ones((2, 2), bool)),
        ((2, 2, 3), np.ones((3, 2), bool)),
        ((2, 2, 3), np.ones((2, 2))),
    ],
)
def test_with_linear_refuses_what_does_not_fit(shape, where):
    with pytest.raises(CutisError):
        texture(np.zeros((2, 2, 3), np.uint8)).with_linear(np.zeros(shape), where)


@pytest.mark.parametrize(
    ("pixels", "channels", "encoding"),
    [
        (np.zeros((2, 2), np.uint8), ("R",), SRGB),
        (np.zeros((2, 2, 3), np.uint8), ("R", "G"), SRGB),
        (np.zeros((2, 2, 3), np.float64), ("R", "G", "B"), SRGB),
        (np.zeros((2, 2, 3), np.uint8), ("R", "G", "Z"), SRGB),
    ],
)
def test_a_texture_must_fit_together(pixels, channels, encoding):
    with pytest.raises(CutisError):
        Texture(pixels, channels, encoding)


def test_channels_are_found_by_name():
    assert colour_channels(["B", "A", "G", "R"]) == ([3, 2, 0], 1)
    assert colour_channels(["diffuse.B", "diffuse.G", "diffuse.R", "Z"]) == ([2, 1, 0], None)
    assert colour_channels(["d.b", "d.g", "d.r", "r", "g", "b"]) == ([3, 4, 5], None)
    assert colour_channels(["v.c.R", "v.c.G", "v.c.B", "v.c.A", "A"]) == ([0, 1, 2], 3)
    with pytest.raises(CutisError, match=r"\(diffuse, spec\)"):
        colour_channels([f"{layer}.{c}" for layer in ("spec", "diffuse") for c in "RGB"])
    with pytest.raises(CutisError, match="only X, Y, Z"):
        colour_channels(["X", "Y", "Z"])


@pytest.mark.parametrize("shape", [(1, 1), (10, 1 << 20), (1 << 20, 1), (1000, 3000), (0, 5)])
def test_bands_cover_every_row_once(shape):
    rows = [row for band in bands(shape) for row in range(*band.indices(shape[0]))]
    assert rows == list(range(shape[0]))


def test_temporaries_stay_small():
    import tracemalloc

    pixels = np.zeros((2048, 2048, 3), np.uint16)
    one = texture(pixels)
    where = everywhere(pixels)
    tracemalloc.start()
    try:
        colour = one.linear()
        linear_peak = tracemalloc.get_traced_memory()[1] - colour.nbytes
        tracemalloc.reset_peak()
        before = tracemalloc.get_traced_memory()[0]
        one.with_linear(colour, where)
        peak = tracemalloc.get_traced_memory()[1] - before - pixels.nbytes
    finally:
        tracemalloc.stop()
    assert linear_peak < 64 << 20
    assert peak < 64 << 20
