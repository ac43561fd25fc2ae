"""Edits of rare chromophores: what they do to maps, colours, spectra and files."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo.rare import rare_ratio
from cutis.colour import reflectance_to_rgb
from cutis.errors import CutisError
from cutis.inverse.model import Model
from cutis.looks import presets
from cutis.luts.recolouring import recolouring
from cutis.maps import Edit, estimate, load_maps, load_model, save_maps, skin_of
from cutis.maps.relighting import STEEPEST
from cutis.optics import ALIAGA2022, MEASURED2026, NAMES, RARE_NAMES, WAVELENGTHS
from cutis.textures import read_channels


@pytest.fixture(scope="module", params=["default", "aliaga2022-exact", "aliaga2022"])
def skin(request, face_rgb, face_mask):
    return estimate(face_rgb, face_mask, model=request.param)


def test_they_are_absent_until_an_edit_sets_them(skin):
    assert skin.rare == ()
    assert skin.bilirubin is None
    ill = skin.replace(bilirubin=0.05)
    assert ill.rare == ("bilirubin",)
    assert np.all(ill.bilirubin[skin.mask > 0] == np.float32(0.05))
    assert np.all(ill.bilirubin[skin.mask == 0] == 0)
    assert ill.original is skin
    assert ill.offset(bilirubin=1.0).clamped[-1] == np.count_nonzero(skin.mask > 0)


@pytest.mark.parametrize("name", RARE_NAMES)
def test_none_of_it_is_the_capture_bit_for_bit(skin, face_rgb, name):
    assert np.array_equal(skin.replace(**{name: 0.0}).albedo(), face_rgb)
    assert np.array_equal(skin.multiply(**{name: 3.0}).albedo(), face_rgb)
    assert np.array_equal(skin.replace(**{name: 0.01}).replace(**{name: 0.0}).albedo(), face_rgb)


def test_colours_change_by_the_ratio_of_the_tissue(skin, face_rgb):
    ill = skin.multiply(melanin=1.3).replace(bilirubin=0.03, methaemoglobin=0.1)
    inside = skin.mask > 0
    after = ill.parameters(names=(*NAMES, *RARE_NAMES))[inside]
    model = load_model(skin.model)
    ratio = model.decode(after[:, :5]) * rare_ratio(skin.tissue, after)
    ratio /= model.decode(skin.parameters()[inside])
    cover = skin.mask[inside][:, None]
    expected = face_rgb[inside] * (1 + cover * (ratio - 1))
    np.testing.assert_allclose(ill.albedo()[inside], expected, rtol=1e-4, atol=1e-6)


def test_a_model_takes_the_ratio_of_its_own_tissue():
    def grey(skins):
        return np.full((len(skins), 3), 0.5, np.float32)

    model = Model("grey", grey, grey, MEASURED2026)
    skins = np.array([[0.02, 0.02, 80, 0.7, 0.7, 0.03, 0.01, 0.2]] * 2, np.float32)
    skins[1, 5:] = 0
    colours = model.decode(skins)
    np.testing.assert_array_equal(colours, 0.5 * rare_ratio(MEASURED2026, skins))
    assert not np.allclose(colours[0], 0.5 * rare_ratio(ALIAGA2022, skins)[0], atol=1e-3)
    assert np.all(colours[1] == 0.5)


def test_presets_look_like_what_they_are_called(skin, face_rgb):
    """Against the capture: less blue when yellow, less red when cyanotic."""
    inside = skin.mask == 1
    ratio = {
        name: np.median(
            (skin.apply(presets.preset(name)).albedo() / np.maximum(face_rgb, 1e-4))[inside], axis=0
        )
        for name in ("jaundice", "carotenaemia", "cyanosis", "methaemoglobinaemia")
    }
    for yellow in ("jaundice", "carotenaemia"):
        red, green, blue = ratio[yellow]
        assert blue < 0.9 < green < red < 1.06  # sRGB's red has a negative lobe at 500 nm
    for slate in ("cyanosis", "methaemoglobinaemia"):
        red, green, _ = ratio[slate]
        assert red < 0.97
        assert red < green


def test_spectra_have_them_too(skin):
    ill = skin.replace(methaemoglobin=0.4)
    inside = skin.mask > 0
    red = list(WAVELENGTHS).index(630.0)
    before, after = (s.reflectance()[inside][:, red] for s in (skin, ill))
    assert np.all(after < before)


def test_other_lights_see_them(skin):
    """What the model explains is the spectrum with them, summed under the light."""
    ill, inside = skin.multiply(melanin=1.3).replace(bilirubin=0.05), skin.mask == 1
    before = reflectance_to_rgb(skin.reflectance(), WAVELENGTHS)
    after = reflectance_to_rgb(ill.reflectance(), WAVELENGTHS, "A")
    ratio = np.clip(after / np.maximum(before, 1e-4), 0, STEEPEST)
    found, plain = ill.relit("A"), skin.multiply(melanin=1.3).relit("A")
    expected = after + (skin.source - before) * ratio
    np.testing.assert_allclose(found[inside], expected[inside], atol=1e-5)
    assert np.median(found[inside][:, 2] / plain[inside][:, 2]) < 0.9


def test_painted_masks_narrow_them(skin, face_rgb):
    where = np.zeros(skin.shape, np.float32)
    where[: skin.shape[0] // 2] = 1
    half = skin.apply(presets.jaundice, where)
    assert np.array_equal(half.albedo()[skin.shape[0] // 2 :], face_rgb[skin.shape[0] // 2 :])
    assert not np.array_equal(half.albedo(), face_rgb)


@pytest.mark.parametrize("dtype", ["float", "half"])
def test_files_keep_them(skin, tmp_path, dtype):
    ill = skin.multiply(blood=1.5).replace(carotene=0.01)
    path = tmp_path / "a.skin.exr"
    save_maps(ill, path, dtype)
    channels, header = read_channels(path)
    assert {"carotene", "original.carotene", "original.blood"} < {*channels}
    assert "bilirubin" not in channels
    assert header["cutis:carotene"] == "β-carotene in the epidermis [g/L], 0 to 0.05"
    again = load_maps(path)
    assert again.rare == ("carotene",)
    assert "carotene" not in again.provenance
    np.testing.assert_allclose(again.carotene, ill.carotene, rtol=1e-3)
    if dtype == "float":
        assert np.array_equal(again.carotene, ill.carotene)
        np.testing.assert_array_equal(again.model_albedo, ill.model_albedo)
        base = again.original.parameters(names=(*NAMES, *RARE_NAMES))
        assert np.array_equal(base, skin.parameters(names=(*NAMES, *RARE_NAMES)))
    rows = slice(3, 9)
    assert np.array_equal(ill.rows(rows).carotene, ill.carotene[rows])


def test_sigma_goes_with_them(skin, tmp_path):
    """That of the five stays with an edit; of a file, also that of a rare map, as a fit has it."""
    sigma = {name: np.where(skin.mask > 0, 0.01, 0).astype(np.float32) for name in NAMES}
    known = replace(skin, spread=sigma, sure=skin.mask)
    ill = known.replace(bilirubin=0.05)
    ill.save(tmp_path / "edited.skin.exr")
    again = load_maps(tmp_path / "edited.skin.exr")
    assert (again.rare, set(again.sigmas)) == (("bilirubin",), {*NAMES})
    np.testing.assert_allclose(again.sigma("blood"), sigma["blood"], rtol=1e-3)
    maps = {name: ill.map(name) for name in (*NAMES, "bilirubin")}
    fitted = skin_of(maps, skin.mask, sigmas={**sigma, "bilirubin": 0.2 * ill.bilirubin})
    fitted.multiply(bilirubin=2).save(tmp_path / "fitted.skin.exr")
    again = load_maps(tmp_path / "fitted.skin.exr")
    np.testing.assert_allclose(again.bilirubin, 2 * ill.bilirubin)
    np.testing.assert_allclose(again.sigma("bilirubin"), 0.4 * ill.bilirubin, rtol=1e-3)
    np.testing.assert_allclose(
        again.rows(slice(2, 5)).sigma("bilirubin"), again.sigma("bilirubin")[2:5]
    )


def test_luts_do_what_edits_do(skin, face_rgb):
    """Far from the fade, the function of a LUT is the edit of texels that see no neighbours."""
    skin = estimate(face_rgb, skin.mask, model=skin.model, steady=False)
    inside = skin.mask == 1
    edit = recolouring(presets.jaundice, skin.model)
    got = edit(face_rgb[inside])
    expected = skin.apply(presets.jaundice).albedo()[inside]
    assert np.median(np.abs(got - expected)) < 1e-5


def test_edits_that_cannot_be():
    with pytest.raises(CutisError, match=r"bilirubin = 0\.5 is outside its range"):
        Edit("bilirubin", "set", 0.5)
    with pytest.raises(CutisError, match="unknown parameter 'biliverdin'"):
        Edit("biliverdin", "set", 0.5)
