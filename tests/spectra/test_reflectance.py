"""Wavelengths and reflectance in whatever unit they come."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.spectra.reflectance import (
    fraction_scale,
    nanometres,
    without_impossible,
)
from cutis.spectra.wavelengths import read_wavelengths


@pytest.mark.parametrize(
    ("values", "unit", "notes"),
    [
        ([400, 550.5], None, 0),
        ([400, 550.5], "Nanometers", 0),
        ([0.4, 0.5505], "Micrometers", 0),
        ([0.4, 0.5505], "um", 0),
        ([0.4, 0.5505], None, 1),
        ([0.4, 0.5505], "Unknown", 1),
    ],
)
def test_wavelengths_become_nm(values, unit, notes):
    found, said = nanometres("a.hdr", values, unit)
    np.testing.assert_allclose(found, [400, 550.5])
    assert len(said) == notes


@pytest.mark.parametrize(
    ("values", "unit"),
    [([], None), ([400, np.nan], None), ([0, 400], None), ([-400.0], None), ([2e4], "cm-1")],
)
def test_what_is_no_wavelength_is_refused(values, unit):
    with pytest.raises(CutisError, match=r"^a\.hdr: "):
        nanometres("a.hdr", values, unit)


def test_percent_is_told_from_fractions():
    rng = np.random.default_rng(0)
    skins = rng.uniform(0.02, 0.7, (50, 31))
    assert fraction_scale("a.csv", skins) == (1.0, [])
    scale, notes = fraction_scale("a.csv", 100 * skins)
    assert scale == 0.01
    assert "percent" in notes[0]
    dark = rng.uniform(0.01, 0.06, (50, 31))
    assert fraction_scale("a.csv", dark)[0] == 1.0
    assert fraction_scale("a.csv", 100 * dark)[0] == 0.01
    hot = skins.copy()
    hot[3, 3] = 1e6  # one broken value does not make a cube percent
    assert fraction_scale("a.csv", hot)[0] == 1.0


def test_other_scales_have_to_be_given():
    counts = np.linspace(100, 6000, 31)
    with pytest.raises(CutisError, match="--scale"):
        fraction_scale("a.img", counts)
    assert fraction_scale("a.img", counts, 10000)[0] == 1e-4
    for wrong in (0.0, -1.0, np.nan):
        with pytest.raises(CutisError, match="above 0"):
            fraction_scale("a.img", counts, wrong)
    for nothing in ([], [np.nan], [-0.1, 0.0]):
        with pytest.raises(CutisError, match="no value above 0"):
            fraction_scale("a.img", nothing)


def test_impossible_values_are_counted_and_left_out():
    found, low, high = without_impossible(np.array([[0.2, -0.01, 1.3, np.nan, np.inf, 0.0]]))
    assert (low, high) == (1, 2)
    assert np.isnan(found[0]).tolist() == [False, True, True, True, True, False]


@pytest.mark.parametrize(
    "text",
    ["400\n410\n420\n", "nm\n400\n410\n420\n", "400,410,420\n", "# λ\n400,1\n410,2\n420,3\n"],
)
def test_lists_of_wavelengths(tmp_path, text):
    path = tmp_path / "w.txt"
    path.write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(read_wavelengths(path)[0], [400, 410, 420])
    np.save(tmp_path / "w.npy", np.array([400, 410, 420]))
    np.testing.assert_array_equal(read_wavelengths(tmp_path / "w.npy")[0], [400, 410, 420])


@pytest.mark.parametrize("data", [b"", b"red\ngreen\n", b"\xff\xfe\x00", b"400\nx\n"])
def test_what_is_no_list_of_wavelengths(tmp_path, data):
    path = tmp_path / "w.txt"
    path.write_bytes(data)
    with pytest.raises(CutisError, match=r"w\.txt: "):
        read_wavelengths(path)
    with pytest.raises(CutisError, match="no such file"):
        read_wavelengths(tmp_path / "absent.txt")
