"""Skin maps as values: chains of edits, masks, and the way back to colour."""

import dataclasses

import numpy as np
import pytest

import cutis
from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.looks import presets
from cutis.maps import Edit, SkinMaps, estimate, load_model
from cutis.maps.patches import patches
from cutis.maps.statistics import BINS
from cutis.optics import NAMES, parameter


@pytest.fixture(scope="module")
def skin(face_rgb, face_mask):
    return estimate(face_rgb, face_mask, white=(1.1, 1.0, 0.95))


def as_dict(maps):
    return {name: getattr(maps, name).copy() for name in NAMES}


def test_maps_cannot_be_changed_in_place(skin):
    with pytest.raises(dataclasses.FrozenInstanceError):
        skin.melanin = skin.blood
    for name in (*NAMES, "mask", "source", "model_albedo"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(skin, name)[0, 0] = 0


def test_arrays_of_the_caller_stay_writable(face_rgb):
    mine = face_rgb.copy()
    maps = estimate(mine)
    mine[:] = 0
    np.testing.assert_array_equal(maps.source, face_rgb)


def test_edits_leave_the_estimate_alone(skin):
    before = as_dict(skin)
    edited = skin.multiply(melanin=2, blood=0.5)
    for name, values in before.items():
        np.testing.assert_array_equal(getattr(skin, name), values)
    assert skin.edits == ()
    assert skin.original is None
    assert edited.original is skin
    assert edited.edits == ("melanin x2", "blood x0.5")


def test_chains(skin):
    inside = skin.mask > 0
    edited = skin.multiply(melanin=1.4).offset(thickness=20).replace(eumelanin=0.2)
    edited = edited.blend(0.25, oxygenation=0.0)
    f = np.float32
    np.testing.assert_allclose(edited.melanin[inside], skin.melanin[inside] * f(1.4), rtol=1e-6)
    np.testing.assert_allclose(edited.thickness[inside], skin.thickness[inside] + 20, rtol=1e-6)
    assert np.all(edited.eumelanin[inside] == f(0.2))
    np.testing.assert_allclose(
        edited.oxygenation[inside], skin.oxygenation[inside] * f(0.75), rtol=1e-6
    )
    np.testing.assert_array_equal(edited.blood, skin.blood)
    assert edited.original is skin
    assert len(edited.edits) == len(edited.clamped) == 4


def test_clamped_texels_are_counted(skin):
    inside = int(np.count_nonzero(skin.mask))
    edited = skin.multiply(melanin=1e6).offset(thickness=1).replace(blood=1.0)
    assert edited.clamped == (inside, 0, 0)
    assert np.all(edited.melanin[skin.mask > 0] == 1)


def test_nothing_outside_the_mask_is_ever_touched(skin, face_rgb):
    outside = skin.mask == 0
    edited = skin.apply(presets.tanning).apply(presets.vitiligo).replace(thickness=10)
    for name in NAMES:
        assert np.all(getattr(edited, name)[outside] == 0)
    np.testing.assert_array_equal(edited.albedo()[outside], face_rgb[outside])
    assert np.all((edited.albedo() != face_rgb)[skin.mask == 1].any(axis=-1))


def test_painted_masks_hide_blend_and_apply(skin):
    paint = np.zeros(skin.shape, np.float32)
    paint[:, 10:20] = 0.5
    paint[:, 20:] = 1
    edited = skin.multiply(melanin=2, where=paint)
    expected = np.where(skin.mask > 0, skin.melanin * (1 + paint), 0)
    np.testing.assert_allclose(edited.melanin, expected, rtol=1e-6)
    np.testing.assert_array_equal(edited.melanin[:, :10], skin.melanin[:, :10])
    np.testing.assert_array_equal(edited.albedo()[:, :10], skin.source[:, :10])


def test_painted_masks_may_be_boolean(skin):
    paint = np.zeros(skin.shape, bool)
    paint[12] = True
    edited = skin.replace(melanin=0.5, where=paint)
    assert np.all(edited.melanin[12, 4:-4] == np.float32(0.5))
    np.testing.assert_array_equal(np.delete(edited.melanin, 12, 0), np.delete(skin.melanin, 12, 0))


def test_vitiligo_comes_in_patches_or_as_painted(skin):
    weight = patches(skin.shape)
    edited = skin.apply(presets.vitiligo)
    spots = (weight == 1) & (skin.mask > 0)
    assert np.all(edited.melanin[spots] == np.float32(0.001))
    np.testing.assert_array_equal(edited.melanin[weight == 0], skin.melanin[weight == 0])
    painted = skin.apply(presets.vitiligo, np.ones(skin.shape))
    assert np.all(painted.melanin[skin.mask > 0] == np.float32(0.001))


def test_amount_is_a_blend(skin):
    inside = skin.mask > 0
    half = skin.apply(presets.melanin_triple, amount=0.5)
    np.testing.assert_allclose(half.melanin[inside], 2 * skin.melanin[inside], rtol=1e-6)
    none = skin.apply(presets.melanin_triple, amount=0.0)
    np.testing.assert_array_equal(none.melanin, skin.melanin)
    np.testing.assert_array_equal(none.albedo(), skin.source)


@pytest.mark.parametrize("amount", [-0.1, 1.1, float("nan")])
def test_amounts_are_shares(skin, amount):
    with pytest.raises(CutisError, match="0 to 1"):
        skin.apply(presets.tanning, amount=amount)


@pytest.mark.parametrize(
    ("where", "message"),
    [
        (np.ones((3, 3)), r"edit mask is \(3, 3\), the maps are \(24, 32\)"),
        (np.full((24, 32), 1.5), "from 0 to 1"),
        (np.full((24, 32), -0.5), "from 0 to 1"),
        (np.full((24, 32), np.nan), "from 0 to 1"),
    ],
)
def test_bad_painted_masks(skin, where, message):
    with pytest.raises(CutisError, match=message):
        skin.multiply(melanin=2, where=where)


def test_unknown_parameters(skin):
    with pytest.raises(CutisError, match="unknown parameter 'freckles'"):
        skin.multiply(freckles=2)


def test_identity_gives_the_capture_back(skin, face_rgb):
    for same in (skin, skin.multiply(melanin=1), skin.offset(thickness=0), skin.apply([])):
        np.testing.assert_array_equal(same.albedo(), face_rgb)


def test_going_there_and_back_gives_the_capture_back(skin, face_rgb):
    back = skin.multiply(blood=2.0).multiply(blood=0.5)
    np.testing.assert_array_equal(back.albedo(), face_rgb)


def test_colours_change_by_the_ratio_of_the_model(skin, face_rgb):
    """Partly covered texels change partly; gains cancel."""
    edited = skin.multiply(melanin=1.4)
    model = load_model("default")
    inside = skin.mask > 0
    ratio = model.decode(edited.parameters()[inside]) / model.decode(skin.parameters()[inside])
    cover = skin.mask[inside][:, None]
    expected = face_rgb[inside] * (1 - cover + cover * ratio)
    np.testing.assert_allclose(edited.albedo()[inside], expected, rtol=2e-6)


def test_more_melanin_is_darker_and_more_blood_is_redder(skin):
    inside = skin.mask == 1
    before, dark = skin.source[inside], skin.multiply(melanin=2).albedo()[inside]
    assert np.all(dark < before)
    red = skin.multiply(blood=3).albedo()[inside]
    assert np.all(red[:, 1] / red[:, 0] < before[:, 1] / before[:, 0])


def test_residual_times_model_is_the_capture(skin, face_rgb):
    inside = skin.mask > 0
    residual = skin.residual()
    np.testing.assert_allclose(residual[inside] * skin.model_albedo[inside], face_rgb[inside], 1e-6)
    assert np.all(residual[~inside] == 1)
    assert np.abs(residual - 1).max() < 0.1
    np.testing.assert_array_equal(skin.multiply(melanin=3).residual(), residual)


def test_model_albedo_is_the_decoded_maps_with_calibration_undone(skin):
    inside = skin.mask > 0
    decoded = load_model("default").decode(skin.parameters()[inside]) / np.float32([1.1, 1, 0.95])
    np.testing.assert_allclose(skin.model_albedo[inside], decoded, rtol=1e-6)
    assert np.all(skin.model_albedo[~inside] == 0)


def test_without_the_capture_albedo_is_that_of_the_model(skin):
    alone = skin.with_capture(None)
    np.testing.assert_array_equal(alone.albedo(), skin.model_albedo)
    with pytest.raises(CutisError, match="without their capture"):
        alone.residual()


def test_reflectance(skin):
    inside = skin.mask > 0
    spectra = skin.reflectance()
    assert spectra.shape == (24, 32, 41)
    np.testing.assert_array_equal(
        spectra[inside], albedo_space(skin.tissue).reflectance(skin.parameters()[inside])
    )
    assert np.all(spectra[~inside] == 0)
    np.testing.assert_array_equal(skin.reflectance(slice(10, 12)), spectra[10:12])


def test_statistics(skin):
    inside = skin.mask > 0
    for name, unit, low, median, high in skin.statistics():
        known = parameter(name)
        assert unit == known.unit
        expected = np.percentile(skin.map(name)[inside], [5, 50, 95], method="inverted_cdf")
        found = known.to_coordinate(np.array([low, median, high]))
        half = 0.5 / BINS + 1e-6  # of a bin, and float32
        np.testing.assert_allclose(found, known.to_coordinate(expected), atol=half, rtol=0)


@pytest.mark.parametrize("kind", ["png8", "png16", "tiff16", "exr"])
@pytest.mark.parametrize("alpha", [False, True], ids=["RGB", "RGBA"])
@pytest.mark.parametrize("masked", [False, True], ids=["whole", "masked"])
def test_identity_is_bit_for_bit_in_files(kind, alpha, masked, write_face, face_mask, tmp_path):
    path = write_face(tmp_path, kind, alpha)
    face = cutis.read(path)
    skin = estimate(face, face_mask if masked else None)
    for same in (skin, skin.multiply(melanin=1.0), skin.offset(blood=0.0)):
        out = tmp_path / f"same{path.suffix}"
        cutis.write(same.retouch(face), out)
        again = cutis.read(out)
        assert again.pixels.dtype == face.pixels.dtype
        assert again.channels == face.channels
        np.testing.assert_array_equal(again.pixels, face.pixels)


@pytest.mark.parametrize("kind", ["png8", "exr"])
def test_retouch_stores_the_edited_albedo(kind, write_face, face_mask, tmp_path):
    face = cutis.read(write_face(tmp_path, kind))
    edited = estimate(face, face_mask).apply(presets.flushing)
    retouched = edited.retouch(face)
    step = 1 / 255 if kind == "png8" else 1e-3
    np.testing.assert_allclose(retouched.linear(), edited.albedo(), atol=step)
    outside = face_mask == 0
    np.testing.assert_array_equal(retouched.pixels[outside], face.pixels[outside])
    assert np.any(retouched.pixels[face_mask == 1] != face.pixels[face_mask == 1])


def test_retouch_refuses_another_size(skin, write_face, tmp_path):
    small = estimate(skin.source[:10])
    with pytest.raises(CutisError, match=r"texture is \(24, 32\), the maps are \(10, 32\)"):
        small.retouch(cutis.read(write_face(tmp_path)))


def test_shapes_must_agree(skin):
    with pytest.raises(CutisError, match="blood is"):
        skin.found.with_values({"blood": skin.blood[:3]})
    with pytest.raises(CutisError, match="source is"):
        skin.with_capture(skin.source[:3])


def test_a_black_capture_stays_finite():
    skin = estimate(np.zeros((4, 4, 3)))
    edited = skin.multiply(melanin=0.1, blood=8)
    assert np.all(edited.albedo() == 0)
    assert np.all(skin.residual() == 0)


def test_apply_takes_one_edit_or_many(skin):
    one = Edit("melanin", "multiply", 1.4)
    assert isinstance(skin.apply(one), SkinMaps)
    np.testing.assert_array_equal(skin.apply(one).melanin, skin.apply([one]).melanin)
