"""Estimates of arrays and textures, of a real capture, and what is refused."""

import dataclasses

import numpy as np
import pytest

import cutis
from cutis.errors import CutisError
from cutis.inverse import MODELS
from cutis.maps import estimate, load_model
from cutis.optics import NAMES
from cutis.report import report


@pytest.mark.parametrize("model", MODELS)
def test_maps_are_what_the_model_says_of_calibrated_colours(model, face_rgb, face_mask):
    skin = estimate(
        face_rgb, face_mask, white=(0.9, 1, 1.1), exposure=1.2, model=model, steady=False
    )
    gains = np.float32([0.9, 1, 1.1]) * np.float32(1.2)
    expected = load_model(model).encode(face_rgb * gains)
    for i, name in enumerate(NAMES):
        values = getattr(skin, name)
        assert values.dtype == np.float32
        inside = face_mask > 0
        np.testing.assert_allclose(values[inside], expected[inside, i], rtol=1e-3)
        assert np.all(values[~inside] == 0)
    assert skin.model == model
    np.testing.assert_array_equal(skin.source, face_rgb)


def test_array_and_texture_agree(write_face, tmp_path):
    face = cutis.read(write_face(tmp_path, "png16"))
    one, other = estimate(face), estimate(face.linear())
    np.testing.assert_array_equal(one.parameters(), other.parameters())


def test_float64_and_strided_arrays(face_rgb):
    skin = estimate(face_rgb.astype(np.float64)[::2, ::2])
    np.testing.assert_array_equal(skin.melanin, estimate(face_rgb[::2, ::2].copy()).melanin)


def test_alpha_is_the_mask_where_none_is_given(write_face, tmp_path, face_mask):
    face = cutis.read(write_face(tmp_path, "png8", alpha=True))
    alpha = face.alpha()
    assert alpha.min() == 0
    np.testing.assert_array_equal(estimate(face).mask, alpha > 0)
    np.testing.assert_array_equal(estimate(face, face_mask).mask, face_mask)


def test_what_is_under_the_mask_does_not_change_the_rest(face_rgb, face_mask):
    other = face_rgb.copy()
    other[face_mask == 0] = (0, 0, 9)
    one, two = (estimate(rgb, face_mask, exposure="auto") for rgb in (face_rgb, other))
    assert one.calibration == two.calibration
    np.testing.assert_array_equal(one.parameters(), two.parameters())


def spoil(value):
    def change(rgb):
        rgb = rgb.copy()
        rgb[3, 5, 1] = value
        return rgb

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (spoil(np.nan), "NaN or infinite"),
        (spoil(-np.inf), "NaN or infinite"),
        (lambda rgb: np.where(rgb > 0.4, 1e300, rgb), "NaN or infinite"),
        (lambda rgb: rgb[..., 0], r"must be \(H, W, 3\) linear sRGB, not \(24, 32\)"),
        (lambda rgb: np.dstack([rgb, rgb[..., :1]]), r"not \(24, 32, 4\)"),
        (lambda rgb: rgb[:0], r"not \(0, 32, 3\)"),
        (lambda rgb: (rgb * 255).astype(np.uint8), "floating-point linear sRGB, not uint8"),
        (lambda rgb: rgb > 0.5, "not bool"),
    ],
)
def test_bad_albedos(change, message, face_rgb):
    with pytest.raises(CutisError, match=message) as caught:
        estimate(change(face_rgb.astype(np.float64)))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("mask", "message"),
    [
        (np.ones((24, 31)), r"mask is \(24, 31\), the albedo is \(24, 32\)"),
        (np.ones((24, 32, 3)), "mask is"),
        (np.zeros((24, 32)), "mask is empty"),
        (np.full((24, 32), 255), "from 0 to 1"),
        (np.full((24, 32), np.nan), "from 0 to 1"),
    ],
)
def test_bad_masks(mask, message, face_rgb):
    with pytest.raises(CutisError, match=message):
        estimate(face_rgb, mask)


def test_unknown_models_are_refused(face_rgb):
    with pytest.raises(CutisError, match="unknown model 'nobody'"):
        estimate(face_rgb, model="nobody")


def test_colours_that_are_no_albedo_are_taken(face_rgb):
    wild = face_rgb.copy()
    wild[0, :3] = [(-0.5, 0.2, 0.1), (3.0, 2.0, 1.0), (1e6, 0, 0)]
    skin = estimate(wild)
    assert np.isfinite(skin.parameters()).all()
    edited = skin.multiply(melanin=1.4).albedo()
    assert np.isfinite(edited).all()


@pytest.fixture(scope="module")
def capture(capture1):
    """(albedo, mask, gains that white balance finds) of the real capture, every eighth texel."""
    path, mask_path = capture1
    face = cutis.read(path)
    mask = cutis.read_mask(mask_path, face.shape)[::8, ::8]
    rgb = np.ascontiguousarray(face.linear()[::8, ::8])
    return rgb, mask, estimate(rgb, mask, white="auto", model="aliaga2022-exact")


@pytest.mark.parametrize(
    ("model", "mse", "mean", "p95"),
    [("aliaga2022", 3e-5, 0.50, 1.5), ("aliaga2022-exact", 5e-6, 0.20, 0.6)],
)
def test_a_real_face_is_explained(model, mse, mean, p95, capture):
    rgb, mask, auto = capture
    skin = auto if model == auto.model else estimate(rgb, mask, white=auto.calibration.gains,
                                                     model=model)  # fmt: skip
    found = report(dataclasses.replace(skin))
    assert found["skin_texels"] > 20_000
    assert found["colour"]["mse"] <= mse
    assert found["colour"]["delta_e_mean"] <= mean
    assert found["colour"]["delta_e_p95"] <= p95
