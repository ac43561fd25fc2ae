"""Names, ranges and coordinates of the five parameters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from cutis.errors import CutisError
from cutis.optics import (
    NAMES,
    PARAMETERS,
    TYPICAL,
    from_coordinates,
    parameter,
    skin,
    to_coordinates,
)

coordinates = arrays(np.float64, (7, 5), elements=st.floats(0, 1))


def test_names_units_and_ranges():
    """DESIGN, section 2."""
    assert NAMES == ("melanin", "blood", "thickness", "eumelanin", "oxygenation")
    assert [p.unit for p in PARAMETERS] == ["1", "1", "µm", "1", "1"]
    assert [(p.low, p.high) for p in PARAMETERS] == [
        (0.001, 1),
        (0.001, 1),
        (10, 250),
        (0.001, 1),
        (0, 0.999),
    ]
    assert [p.root for p in PARAMETERS] == [3, 4, 1, 1, 1]


@given(coordinates)
def test_round_trip_from_coordinates(u):
    values = from_coordinates(u)
    for i, p in enumerate(PARAMETERS):
        assert np.all((values[..., i] >= p.low) & (values[..., i] <= p.high))
    np.testing.assert_allclose(to_coordinates(values), u, atol=1e-12)


@given(coordinates)
def test_coordinates_keep_order(u):
    for i in range(5):
        order = np.argsort(u[:, i], kind="stable")
        assert np.all(np.diff(from_coordinates(u)[order, i]) >= -1e-15)


def test_ends_are_zero_and_one():
    low, high = np.array([p.low for p in PARAMETERS]), np.array([p.high for p in PARAMETERS])
    np.testing.assert_allclose(to_coordinates(low), 0, atol=1e-14)
    np.testing.assert_allclose(to_coordinates(high), 1, rtol=1e-14)
    np.testing.assert_allclose(from_coordinates(np.full(5, -0.5)), low, rtol=1e-14)
    np.testing.assert_allclose(from_coordinates(np.full(5, 1.5)), high, rtol=1e-14)


def test_halfway_by_hand():
    """u = ½: melanin is the cube, blood the fourth power, of the middle of the roots."""
    half = from_coordinates(np.full(5, 0.5))
    expected = [((0.1 + 1) / 2) ** 3, ((0.001**0.25 + 1) / 2) ** 4, 130, 0.5005, 0.4995]
    np.testing.assert_allclose(half, expected, rtol=1e-12)


def test_float32_stays():
    u = np.random.default_rng(0).random((4, 3, 5), dtype=np.float32)
    assert from_coordinates(u).dtype == np.float32
    assert to_coordinates(from_coordinates(u)).shape == (4, 3, 5)


def test_parameter_by_name():
    assert parameter("blood") is PARAMETERS[1]


@pytest.mark.parametrize("name", ["Melanin", "", "haemoglobin"])
def test_unknown_names_are_one_line(name):
    for call in (lambda: parameter(name), lambda: skin({name: 0.5})):
        with pytest.raises(CutisError, match="melanin, blood, thickness") as caught:
            call()
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("p", PARAMETERS, ids=NAMES)
def test_out_of_range_is_one_line(p):
    for value in (p.low - 0.001, p.high * 1.01 + 0.01, np.nan, np.inf, -np.inf):
        with pytest.raises(CutisError, match=p.name) as caught:
            skin({p.name: value})
        assert "\n" not in str(caught.value)
    for value in (p.low, p.high):
        assert p.check(value) == value


def test_range_names_its_unit():
    with pytest.raises(CutisError, match="10 to 250 µm"):
        skin({"thickness": 5.0})


def test_typical_skin():
    np.testing.assert_array_equal(skin({}), [TYPICAL[name] for name in NAMES])
    assert skin({"blood": 0.5})[1] == 0.5
