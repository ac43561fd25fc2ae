"""The packaged tables are those of colour-science, and of the CIE."""

import numpy as np
import pytest

from cutis.colour import illuminant
from cutis.colour.observer import colour_matching, wavelengths
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


@pytest.mark.parametrize("name", ["D66", "", "lambda_nm"])
def test_unknown_illuminant_is_one_line(name):
    with pytest.raises(CutisError, match="D65") as caught:
        illuminant(name)
    assert "\n" not in str(caught.value)
