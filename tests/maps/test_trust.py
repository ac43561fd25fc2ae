"""σ and confidence of maps: estimated, edited, stored, weighed against the prior."""

import copy
from dataclasses import replace

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.maps import Edit, estimate, load_maps, load_model
from cutis.maps.trust import EVEN, TrustStatistics, prior_sigma
from cutis.optics import NAMES, PARAMETERS, to_coordinates
from cutis.report import report
from cutis.textures import read_channels, write_channels


@pytest.fixture
def skin(trusting, face_rgb, face_mask):
    return estimate(face_rgb, face_mask, white=(1.1, 1.0, 0.95))


def test_sigma_is_that_of_the_model_of_the_calibrated_colour(skin, trusting, face_rgb, face_mask):
    inside = face_mask > 0
    expected = trusting.trust(face_rgb[inside] * np.float32([1.1, 1.0, 0.95]))
    for i, name in enumerate(NAMES):
        np.testing.assert_array_equal(skin.sigma(name)[inside], expected[:, i])
        assert skin.sigma(name)[~inside].max() == 0
    np.testing.assert_array_equal(skin.confidence[inside], expected[:, 5])
    assert not skin.sigma("melanin").flags.writeable


def test_bands_of_rows_are_parts_of_the_whole(skin):
    part = skin.rows(slice(5, 9))
    np.testing.assert_array_equal(part.sigma("blood"), skin.sigma("blood")[5:9])
    np.testing.assert_array_equal(part.confidence, skin.confidence[5:9])


def test_models_that_know_none_say_so(face_rgb):
    maps = estimate(face_rgb, model="aliaga2022")
    assert (maps.sigmas, maps.confidence) == ({}, None)
    with pytest.raises(CutisError, match="no σ of melanin: aliaga2022 does not know it"):
        maps.sigma("melanin")
    with pytest.raises(CutisError, match="unknown parameter"):
        maps.sigma("freckles")


def test_sigma_can_be_left_out(trusting, face_rgb):
    maps = estimate(face_rgb, sigma=False)
    assert maps.sigmas == {}
    with pytest.raises(CutisError, match="made without; estimate again"):
        maps.sigma("melanin")


def test_maps_can_be_copied(skin):
    np.testing.assert_array_equal(copy.deepcopy(skin).sigma("blood"), skin.sigma("blood"))


def test_sigma_of_another_size_is_refused(skin):
    with pytest.raises(CutisError, match="σ of blood is"):
        replace(skin, spread={"blood": np.zeros((2, 2))})


def test_edits_carry_sigma_on(skin):
    before = skin.sigma("melanin")
    np.testing.assert_array_equal(skin.multiply(melanin=0.5).sigma("melanin"), before / 2)
    np.testing.assert_array_equal(skin.offset(melanin=0.01).sigma("melanin"), before)
    assert skin.replace(melanin=0.1).sigma("melanin").max() == 0
    half = skin.blend(0.25, melanin=0.1).sigma("melanin")
    np.testing.assert_allclose(half, 0.75 * before, rtol=1e-6)
    np.testing.assert_array_equal(skin.multiply(blood=3).sigma("melanin"), before)
    paint = np.zeros(skin.shape, np.float32)
    paint[:, ::2] = 1
    painted = skin.multiply(where=paint, melanin=2).sigma("melanin")
    np.testing.assert_allclose(painted, before * (1 + paint), rtol=1e-6)


def test_edited_sigma_is_the_spread_of_edited_values():
    """Against samples, away from the ends of the range."""
    values = np.random.default_rng(2).normal(0.3, 0.02, 40_000).astype(np.float32)
    weight = np.full(values.shape, 0.6, np.float32)
    for edit in (Edit("melanin", "multiply", 1.7), Edit("melanin", "offset", 0.1),
                 Edit("melanin", "set", 0.2)):  # fmt: skip
        found = edit.sigma(np.float32([values.std()]), np.float32([0.6]))
        np.testing.assert_allclose(found, edit(values, weight)[0].std(), rtol=1e-4)


def test_no_sigma_is_wider_than_the_range(skin):
    assert skin.multiply(eumelanin=9).sigma("eumelanin").max() == np.float32(0.999)


def test_files_keep_sigma_as_half(skin, tmp_path):
    skin.save(tmp_path / "a.skin.exr")
    again = load_maps(tmp_path / "a.skin.exr")
    np.testing.assert_array_equal(again.parameters(), skin.parameters())  # float
    for name in NAMES:
        stored = skin.sigma(name).astype(np.float16).astype(np.float32)
        np.testing.assert_array_equal(again.sigma(name), stored)
    np.testing.assert_array_equal(again.confidence, skin.confidence)
    edited = again.multiply(melanin=2)
    edited.save(tmp_path / "b.skin.exr")
    np.testing.assert_allclose(
        load_maps(tmp_path / "b.skin.exr").sigma("melanin"), edited.sigma("melanin"), rtol=1e-3
    )


def test_what_a_file_says_that_cannot_be_is_nothing_known(skin, tmp_path):
    skin.save(tmp_path / "a.skin.exr")
    channels, header = read_channels(tmp_path / "a.skin.exr")
    del channels["blood.sigma"]
    channels["melanin.sigma"][:] = np.nan
    channels["thickness.sigma"][:] = 5000
    channels["confidence"][:] = [[-3, np.nan] * 16]
    header = {k: v for k, v in header.items() if k.startswith("cutis:")}
    write_channels(tmp_path / "b.skin.exr", channels, "float", header)
    found, inside = load_maps(tmp_path / "b.skin.exr"), skin.mask > 0
    assert set(found.sigmas) == set(NAMES) - {"blood"}
    np.testing.assert_allclose(found.sigma("melanin")[inside], 0.999)
    np.testing.assert_allclose(found.sigma("thickness")[inside], 240)
    assert found.confidence.max() == 0


def test_the_report_weighs_sigma_against_the_prior(skin, trusting):
    found = report(skin)
    sure = (skin.mask > 0) & (skin.confidence >= 0.5)
    assert found["low_confidence"] == pytest.approx(1 - sure.sum() / (skin.mask > 0).sum())
    assert 0 < found["low_confidence"] < 1
    u = to_coordinates(skin.parameters()[sure].astype(float))
    for i, known in enumerate(PARAMETERS):
        row, sigma = found["maps"][known.name], skin.sigma(known.name)[sure]
        width = known.high - known.low
        assert row["sigma"] == pytest.approx(np.median(sigma), abs=width / 30000)
        low, high = known.low ** (1 / known.root), known.high ** (1 / known.root)
        slope = known.root * (high - low) * (low + u[:, i] * (high - low)) ** (known.root - 1)
        even = np.median(sigma / slope)
        assert row["informed"] == pytest.approx(max(0, 1 - even / 0.2), abs=2e-3)


def test_without_confident_texels_there_is_nothing_to_say(skin):
    doubtful = report(replace(skin, sure=np.zeros(skin.shape)))
    assert doubtful["low_confidence"] == 1
    assert "informed" not in doubtful["maps"]["melanin"]
    plain = report(replace(skin, spread={}, sure=None))
    assert "low_confidence" not in plain


def test_without_a_prior_any_value_was_as_likely():
    assert load_model("aliaga2022").prior_sigma is None
    assert prior_sigma(load_model("aliaga2022")) == (EVEN,) * 5 == prior_sigma(None)
    values = np.random.default_rng(0).random(100_000)
    assert values.std() == pytest.approx(EVEN, rel=5e-3)


def test_statistics_of_nothing():
    assert TrustStatistics().finish(None) == {}
    assert TrustStatistics().low_confidence() is None


def test_medians_are_of_the_texels_that_are_likely_skin():
    """Hair inside the mask changes neither σ nor the value that σ is a share of."""
    values = np.array([[0.02] * 4 + [0.9] * 6], np.float32)
    u = to_coordinates(np.full((1, 10, 5), 0.5)).astype(np.float32)
    u[0, :, 0] = PARAMETERS[0].to_coordinate(values[0])
    confidence = (values < 0.5).astype(np.float32)
    statistics = TrustStatistics()
    sigmas = {"melanin": np.where(values < 0.5, 0.002, 0.5).astype(np.float32)}
    statistics.add(sigmas, confidence, u, np.ones((1, 10), bool))
    found = statistics.finish(load_model("measured2026"))["melanin"]
    assert found["sure_median"] == pytest.approx(0.02, rel=1e-2)
    assert found["sigma"] == pytest.approx(0.002, rel=1e-2)
    assert statistics.low_confidence() == pytest.approx(0.6)
