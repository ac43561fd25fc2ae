"""Files of maps that version 0.1 wrote read as they did then."""

from pathlib import Path

import numpy as np
import pytest

import cutis

FILES = Path(__file__).with_name("files")


@pytest.fixture(scope="module")
def then():
    with np.load(FILES / "face-0.1.npz") as stored:
        return dict(stored)


def test_maps_sigma_and_calibration(then):
    skin = cutis.load(FILES / "face-0.1.skin.exr")
    np.testing.assert_array_equal(skin.parameters(), then["parameters"])
    np.testing.assert_allclose(skin.sigma("melanin"), then["sigma"], rtol=1e-3)
    assert skin.made_by.name == "measured2026"
    assert skin.calibration.gains == (1.1, 1.0, 0.95)
    assert skin.calibration.light == "A"
    np.testing.assert_array_equal(skin.albedo(), cutis.read(FILES / "face-0.1.png").linear())


def test_edited_maps(then):
    skin = cutis.load(FILES / "edited-0.1.skin.exr")
    np.testing.assert_array_equal(skin.parameters(), then["edited"])
    np.testing.assert_array_equal(skin.bilirubin, then["bilirubin"])
    assert skin.edits == ("melanin x1.4", "bilirubin 0.02")
    np.testing.assert_allclose(skin.albedo(), then["albedo"], atol=2e-6)
    again = skin.multiply(blood=0.5)
    assert again.edits[-1] == "blood x0.5"
    assert again.original is not None
