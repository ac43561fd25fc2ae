import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.render.frames import edit_sweep, file_names, turntable


def test_a_turntable_goes_once_around_and_does_not_end_where_it_began():
    frames = turntable(8)
    assert [f.turn for f in frames] == [0, 45, 90, 135, 180, 225, 270, 315]
    assert [f.number for f in frames] == list(range(1, 9))


def test_factors_are_in_equal_ratios():
    edits = [frame.edits[0] for frame in edit_sweep("melanin", "0.5..3", 5)]
    amounts = np.array([edit.amount for edit in edits])
    assert {edit.operation for edit in edits} == {"multiply"}
    np.testing.assert_allclose(amounts[[0, -1]], [0.5, 3])
    np.testing.assert_allclose(amounts[1:] / amounts[:-1], 6 ** (1 / 4), rtol=1e-4)


@pytest.mark.parametrize(
    ("text", "operation", "amounts"),
    [
        ("x1..4", "multiply", [1, 2, 4]),
        ("0..2", "multiply", [0, 1, 2]),
        ("+0..0.1", "offset", [0, 0.05, 0.1]),
        ("+-0.1..0.1", "offset", [-0.1, 0, 0.1]),
        ("=0.01..0.3", "set", [0.01, 0.155, 0.3]),
        ("3..0.75", "multiply", [3, 1.5, 0.75]),
    ],
)
def test_ranges(text, operation, amounts):
    edits = [frame.edits[0] for frame in edit_sweep("melanin", text, 3)]
    assert {edit.operation for edit in edits} == {operation}
    np.testing.assert_allclose([edit.amount for edit in edits], amounts, atol=1e-12)


@pytest.mark.parametrize("text", ["", "1", "1..", "..2", "a..b", "1.2.3..4", "nan..2", "=0.5..2"])
def test_other_ranges_are_refused(text):
    with pytest.raises(CutisError):
        edit_sweep("melanin", text, 3)


def test_unknown_parameters_and_counts_are_refused():
    with pytest.raises(CutisError, match="melanin"):
        edit_sweep("sunburn", "1..2", 3)
    with pytest.raises(CutisError, match="2 to"):
        turntable(1)


def test_files_sort_in_the_order_of_frames():
    names = [name for _, name in file_names(turntable(12), "out/face", ".png")]
    assert names[0] == "out/face.0001.png"
    assert names == sorted(names)
