"""Edits as values: what they do to numbers, and how people write them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutis.errors import CutisError
from cutis.maps import Edit, parse_edit
from cutis.optics import NAMES, PARAMETERS, parameter

VALUES = np.array([[0.001, 0.02], [0.3, 1.0]], dtype=np.float32)


@pytest.mark.parametrize(
    ("edit", "expected", "clamped"),
    [
        (Edit("melanin", "multiply", 2.0), [[0.002, 0.04], [0.6, 1.0]], 1),
        (Edit("melanin", "offset", 0.01), [[0.011, 0.03], [0.31, 1.0]], 1),
        (Edit("melanin", "offset", -0.1), [[0.001, 0.001], [0.2, 0.9]], 2),
        (Edit("melanin", "set", 0.05), [[0.05, 0.05], [0.05, 0.05]], 0),
        (Edit("melanin", "multiply", 0.0), [[0.001, 0.001], [0.001, 0.001]], 4),
        (Edit("melanin", "multiply", 1e30), [[1, 1], [1, 1]], 4),
    ],
)
def test_arithmetic_and_clamping(edit, expected, clamped):
    edited, count = edit(VALUES)
    np.testing.assert_allclose(edited, np.array(expected, np.float32), rtol=1e-6)
    assert edited.dtype == np.float32
    assert count == clamped
    assert VALUES[0, 1] == np.float32(0.02)


def test_weight_blends_and_its_zeros_do_not_count_as_clamped():
    weight = np.array([[0.0, 0.25], [0.5, 1.0]], dtype=np.float32)
    edited, clamped = Edit("melanin", "multiply", 2.0)(VALUES, weight)
    np.testing.assert_allclose(edited, [[0.001, 0.025], [0.45, 1.0]], rtol=1e-6)
    assert edited[0, 0] == VALUES[0, 0]
    assert clamped == 1


@pytest.mark.parametrize("known", PARAMETERS, ids=NAMES)
def test_setting_gives_the_value_itself(known):
    """Not one that rounding moved past the end of the range."""
    values = np.random.default_rng(0).uniform(known.low, known.high, 1000).astype(np.float32)
    for end in (known.low, known.high):
        edited, clamped = Edit(known.name, "set", end)(values, np.ones_like(values))
        assert np.all(edited == np.float32(end))
        assert clamped == 0


@given(
    value=st.floats(np.float32(0.001).item(), 1, width=32),
    weight=st.floats(0, 1, width=32),
    amount=st.floats(0, 20),
    operation=st.sampled_from(["multiply", "offset"]),
)
def test_always_in_range_and_between_old_and_new(value, weight, amount, operation):
    old = np.array([value], dtype=np.float32)
    edited, _ = Edit("blood", operation, amount)(old, np.array([weight], dtype=np.float32))
    new, _ = Edit("blood", operation, amount)(old)
    assert np.float32(0.001) <= edited[0] <= np.float32(1)
    assert min(old[0], new[0]) <= edited[0] <= max(old[0], new[0])
    if weight == 0 or new[0] == old[0]:
        assert edited[0] == old[0]


@given(st.floats(0, 1e6, allow_subnormal=False))
def test_parsing_is_the_inverse_of_writing(amount):
    for operation, text in (("multiply", f"x{amount!r}"), ("offset", f"+{amount!r}")):
        assert parse_edit("melanin", text) == Edit("melanin", operation, amount)
    assert parse_edit("melanin", f"-{amount!r}") == Edit("melanin", "offset", -amount)
    share = 0.001 + 0.999 * amount / 1e6
    assert parse_edit("melanin", f" {share!r} ") == Edit("melanin", "set", share)


@pytest.mark.parametrize("sign", ["x", "X", "×", "*"])
def test_factors_may_be_written_in_several_ways(sign):
    assert parse_edit("blood", f"{sign}0.5") == Edit("blood", "multiply", 0.5)


def attempt(text: str) -> Edit | CutisError:
    try:
        return parse_edit("thickness", text)
    except CutisError as error:
        return error


@given(st.text(max_size=8))
def test_any_text_is_an_edit_or_one_clear_line(text):
    result = attempt(text)
    if isinstance(result, Edit):
        assert np.isfinite(result.amount)
    else:
        assert "thickness" in str(result)
        assert len(str(result).splitlines()) == 1


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("melanin", "", "takes a value"),
        ("melanin", "x", "takes a value"),
        ("melanin", "dark", "takes a value"),
        ("melanin", "nan", "cannot set"),
        ("melanin", "x-1", "cannot multiply"),
        ("melanin", "+inf", "cannot offset"),
        ("melanin", "1.5", r"outside its range 0\.001 to 1"),
        ("thickness", "5", "10 to 250 µm"),
        ("colour", "1", "unknown parameter 'colour'"),
    ],
)
def test_what_is_no_edit(name, text, message):
    with pytest.raises(CutisError, match=message):
        parse_edit(name, text)


def test_unknown_operations_and_places_are_refused():
    with pytest.raises(CutisError, match="unknown operation"):
        Edit("melanin", "divide", 2.0)
    with pytest.raises(CutisError, match="unknown place"):
        Edit("melanin", "multiply", 2.0, where="nose")


def test_edits_say_what_they_do():
    assert str(Edit("melanin", "multiply", 1.4)) == "melanin x1.4"
    assert str(Edit("thickness", "offset", -20)) == "thickness -20"
    assert str(Edit("blood", "set", 0.02)) == "blood 0.02"
    assert str(Edit("melanin", "set", 0.001, "patches")) == "melanin 0.001 in patches"
    assert parameter("melanin").low == 0.001
