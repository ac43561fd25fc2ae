"""The packaged tables are those of colour-science, and of the CIE."""

import numpy as np
import pytest

from cutis.colour import illuminant
from cutis.colour.observer import colour_matching, read_light, wavelengths
from cutis.errors import CutisError
from cutis.optics.tables import packaged_table


def test_wavelengths():
    np.testing.assert_array_equal(wavelengths(), np.arange(380, 781, 5))


def test_observer_is_that_of_colour_science():
    from colour import MSDS_CMFS

    cmfs = MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    np.testing.assert_allclose(colour_matching(), [cmfs[w] for w in wavelengths()], rtol=1e-14)


def test_illuminants_are_those_of_colour_science():
    from colour import SDS_ILLUMINANTS

    names = [name for name in packaged_table("colour", "illuminants") if name != "lambda_nm"]
    assert {"A", "D50", "D65", "FL11", "LED-B3"} <= set(names)
    for name in names:
        expected = [SDS_ILLUMINANTS[name][w] for w in wavelengths()]
        np.testing.assert_allclose(illuminant(name), expected, rtol=1e-14)


def test_a_few_printed_values():
    """CIE 15: ȳ(555 nm) = 1, x̄(600 nm) = 1.0622, D65 and A are 100 at 560 nm [cie15]."""
    at = list(wavelengths()).index
    assert colour_matching()[at(555), 1] == pytest.approx(1, abs=1e-9)
    assert colour_matching()[at(600), 0] == pytest.approx(1.0622, abs=1e-9)
    assert illuminant("D65")[at(560)] == pytest.approx(100, abs=1e-9)
    assert illuminant("A")[at(560)] == pytest.approx(100, abs=1e-9)


def test_names_ignore_case_and_tables_are_not_writable():
    assert illuminant("d65") is illuminant("D65")
    with pytest.raises(ValueError, match="read-only"):
        illuminant("D65")[0] = 1


@pytest.mark.parametrize("name", ["sunshine", "", "lambda_nm", "D6", "FL99"])
def test_unknown_illuminant_is_one_line(name):
    with pytest.raises(CutisError, match="D65") as caught:
        illuminant(name)
    assert "\n" not in str(caught.value)


def test_near_names_are_offered():
    with pytest.raises(CutisError, match="is it FL1"):
        illuminant("FL1 1")


def test_aliases():
    assert illuminant("F11") is illuminant("FL11")
    assert illuminant("f3.5") is illuminant("FL3.5")
    for name in ("D65'", "D65′", "d65prime", "D65-Prime"):
        assert illuminant(name) is illuminant("D65-prime")


@pytest.mark.parametrize("name", ["D65-prime", "D65-prime-RGB", "D65-prime-RGBW"])
def test_the_white_of_d65_prime(name):
    """x 0.3046, y 0.3209, all that is known of that light."""
    xyz = illuminant(name) @ colour_matching()
    np.testing.assert_allclose(xyz[:2] / xyz.sum(), [0.3046, 0.3209], atol=1e-12)
    assert illuminant(name).min() >= 0


def test_daylight_of_any_temperature():
    """The formula gives the tabulated D65 and D75 again; D93 is bluer than both."""
    for name in ("D65", "D75"):
        long = f"{name}00"
        np.testing.assert_allclose(illuminant(long), illuminant(name), rtol=3e-3)
    blue = [(illuminant(n) @ colour_matching())[0] / (illuminant(n) @ colour_matching()).sum()
            for n in ("D65", "D75", "D93", "D10000")]  # fmt: skip
    assert blue == sorted(blue, reverse=True)
    with pytest.raises(CutisError, match="D40 to D250"):
        illuminant("D30")


def write(path, lam, power, separator=","):
    lines = [f"{w}{separator}{p}" for w, p in zip(lam, power, strict=True)]
    path.write_text("# a lamp\nwavelength_nm,power\n" + "\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("separator", [",", ";", "\t", "  "])
def test_a_light_from_a_file(tmp_path, separator):
    path = write(tmp_path / "a.csv", wavelengths(), illuminant("A"), separator)
    np.testing.assert_allclose(illuminant(str(path)), illuminant("A"), rtol=1e-12)
    coarse = write(tmp_path / "b.txt", wavelengths()[::2], illuminant("A")[::2])
    np.testing.assert_allclose(read_light(coarse)[::2], illuminant("A")[::2], rtol=1e-12)


GOOD = np.arange(400.0, 701.0, 10.0)


@pytest.mark.parametrize(
    ("lam", "power", "what"),
    [
        (GOOD[::3], np.ones(11), "gaps"),
        (GOOD[3:], np.ones(28), "gaps"),
        (GOOD[:-3], np.ones(28), "gaps"),
        (np.delete(GOOD, [10, 11]), np.ones(29), "gaps"),
        (GOOD[::-1], np.ones(31), "increase"),
        (GOOD / 1000, np.ones(31), "gaps"),
        (GOOD, -np.ones(31), "negative"),
        (GOOD, np.zeros(31), "zero"),
        (GOOD, np.full(31, np.nan), "finite"),
        (GOOD, np.full(31, np.inf), "finite"),
        (GOOD, ["x"] * 31, "is not wavelength"),
        ([], [], "needs rows"),
    ],
)
def test_bad_spectral_files_are_one_line(tmp_path, lam, power, what):
    path = write(tmp_path / "lamp.csv", lam, power)
    with pytest.raises(CutisError, match=what) as caught:
        illuminant(str(path))
    assert "lamp.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("row", ["{:g};0,5", "{:g},1,2", "{:g}"])
def test_rows_of_other_than_two_numbers_are_refused(row, tmp_path):
    """Decimal commas too: 0,5 would otherwise be read as 0."""
    (tmp_path / "lamp.csv").write_text("\n".join(row.format(w) for w in GOOD))
    with pytest.raises(CutisError, match="two numbers each"):
        illuminant(str(tmp_path / "lamp.csv"))


def test_files_that_are_none(tmp_path):
    with pytest.raises(CutisError, match="no such file"):
        illuminant(str(tmp_path / "gone.csv"))
    (tmp_path / "picture.csv").write_bytes(b"\xff\xfe\x00\x80" * 9)
    with pytest.raises(CutisError, match="not a text file"):
        illuminant(str(tmp_path / "picture.csv"))
