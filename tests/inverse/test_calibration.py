"""Gains of a capture: found where they can be, taken as given where they are."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.albedo.lights import skin_conversion
from cutis.colour import delta_e, light_conversion
from cutis.errors import CutisError
from cutis.inverse.calibration import Calibration, calibrate
from cutis.maps import load_model
from cutis.optics import ALIAGA2022, MEASURED2026

CAST = np.array([1.24, 0.98, 0.94])
"""The cast of a renderer that forgets its illuminant (DESIGN.md §3)."""


@pytest.fixture(scope="module")
def palette():
    """(150, 3) colours of plausible light to brown skins."""
    rng = np.random.default_rng(11)
    count = 150
    skins = np.stack(
        [
            np.exp(rng.uniform(np.log(0.008), np.log(0.1), count)),
            np.exp(rng.uniform(np.log(0.005), np.log(0.08), count)),
            rng.uniform(40, 120, count),
            rng.uniform(0.4, 0.9, count),
            rng.uniform(0.5, 0.9, count),
        ],
        axis=-1,
    )
    return albedo_space(ALIAGA2022).rgb(skins)


def unexplained(rgb):
    model = load_model("default")
    return delta_e(model.decode(model.encode(rgb)), rgb)


def test_nothing_asked_nothing_done(palette):
    assert calibrate(palette, ALIAGA2022) == Calibration()
    assert calibrate(palette, ALIAGA2022, "none", "none") == Calibration((1.0, 1.0, 1.0), "none")


def test_given_gains_are_used_verbatim(palette):
    assert calibrate(palette, ALIAGA2022, (0.9, 1.0, 1.1)) == Calibration((0.9, 1.0, 1.1), "given")
    assert calibrate(palette, ALIAGA2022, None, 1.5).gains == (1.5, 1.5, 1.5)
    np.testing.assert_allclose(
        calibrate(palette, ALIAGA2022, (0.9, 1.0, 1.1), 2.0).gains, (1.8, 2.0, 2.2)
    )


def test_undo_is_the_inverse_of_apply(palette):
    calibration = Calibration((0.83, 1.04, 1.31), "given")
    applied = calibration.apply(palette)
    assert applied.dtype == np.float32
    np.testing.assert_allclose(applied, palette * np.array(calibration.gains), rtol=1e-6)
    np.testing.assert_allclose(calibration.undo(applied), palette, rtol=3e-7)


@pytest.mark.parametrize("light", ["A", "FL4", "LED-RGB1"])
def test_light_before_gains_and_back(light, palette):
    """White under the light becomes the gains; undo is the inverse."""
    calibration = calibrate(palette, ALIAGA2022, (0.9, 1.0, 1.1), light=light)
    assert (calibration.light, calibration.gains) == (light, (0.9, 1.0, 1.1))
    np.testing.assert_allclose(calibration.apply(np.ones((1, 3))), [[0.9, 1.0, 1.1]], rtol=1e-6)
    expected = palette @ light_conversion(light).T * np.array(calibration.gains)
    np.testing.assert_allclose(calibration.apply(palette), expected, rtol=3e-6)
    np.testing.assert_allclose(calibration.undo(calibration.apply(palette)), palette, rtol=3e-6)


def test_the_tissue_says_how_to_convert(palette):
    exact = calibrate(palette, MEASURED2026, light="A")
    np.testing.assert_allclose(exact.conversion, skin_conversion("A", MEASURED2026))
    np.testing.assert_allclose(
        calibrate(palette, ALIAGA2022, light="A").conversion, light_conversion("A")
    )
    np.testing.assert_allclose(exact.undo(exact.apply(palette)), palette, rtol=3e-6)


def test_gains_are_searched_in_the_space_of_the_tissue():
    """Pale, bloodless skins of the measured tissue, a tenth too dark."""
    skins = halton(600, 2)[:, :5]
    skins[:, 0] = 0.003 + 0.02 * skins[:, 0]
    rgb = 0.8 * albedo_space(MEASURED2026).rgb(skins)
    own, other = (calibrate(rgb, t, white="auto").gains for t in (MEASURED2026, ALIAGA2022))
    assert np.abs(np.log(own) - np.log(other)).max() > 0.02


def test_gains_are_searched_under_d65(palette):
    under_a = palette @ np.linalg.inv(light_conversion("A")).T
    found = calibrate(under_a, ALIAGA2022, exposure="auto", light="A")
    np.testing.assert_allclose(
        found.gains, calibrate(palette, ALIAGA2022, exposure="auto").gains, rtol=1e-3
    )


def test_a_capture_without_a_cast_keeps_its_gains_near_one(palette):
    found = calibrate(palette, ALIAGA2022, white="auto")
    assert found.origin == "auto"
    np.testing.assert_allclose(found.gains, 1.0, atol=0.05)


def test_a_cast_is_found(palette):
    """Within 10 % per channel: how much of a cast is skin tone, colours alone cannot tell."""
    cast = (palette * CAST).astype(np.float32)
    found = calibrate(cast, ALIAGA2022, white="auto")
    np.testing.assert_allclose(np.array(found.gains) * CAST, 1.0, atol=0.10)
    before, after = unexplained(cast), unexplained(found.apply(cast))
    assert after.mean() < 0.25
    assert np.percentile(after, 95) < 0.8
    assert after.mean() < before.mean() / 3


def test_exposure_alone_is_one_gain_for_all(palette):
    found = calibrate(palette * np.float32(1.8), ALIAGA2022, exposure="auto")
    assert len(set(found.gains)) == 1
    assert found.gains[0] < 1.0
    assert found.origin == "auto"


@pytest.mark.parametrize(
    ("white", "exposure"),
    [
        ("sunny", None),
        (None, "bright"),
        ((1.0, 1.0), None),
        ((1.0, 0.0, 1.0), None),
        ((1.0, 1.0, 11.0), None),
        ((1.0, float("nan"), 1.0), None),
        (("a", "b", "c"), None),
        (None, -1.0),
        (None, float("inf")),
    ],
)
def test_anything_else_is_refused_in_one_line(white, exposure, palette):
    with pytest.raises(CutisError, match=r"^(white|exposure) ") as caught:
        calibrate(palette, ALIAGA2022, white, exposure)
    assert "\n" not in str(caught.value)


def test_black_cannot_be_calibrated():
    with pytest.raises(CutisError, match="too few texels"):
        calibrate(np.zeros((500, 3)), ALIAGA2022, white="auto")
