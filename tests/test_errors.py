import pickle

import pytest

from cutis.errors import CutisError


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a: ΔE is 3 µm × 2", "a: ΔE is 3 µm × 2"),
        ("two\nlines\r\nor\u2028three", "two lines or three"),
        ("\x1b[2Jgone", "\\x1b[2Jgone"),
        ("right\u202eto left", "right\\u202eto left"),
        ("half \udcff", "half \\udcff"),
    ],
)
def test_a_message_is_one_line_that_prints(text, shown):
    error = CutisError(text)
    assert str(error) == shown
    assert str(error).encode()
    assert str(pickle.loads(pickle.dumps(error))) == shown
