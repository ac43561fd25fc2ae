"""Looks from strangers: what they say of themselves is cut short in messages."""

import pytest

from cutis.errors import CutisError
from cutis.looks import Look


@pytest.mark.parametrize(
    "text",
    [
        '{"cutis_look": 1, "layers": [{' + '"a": {' * 400 + "}" * 400 + "}]}",
        '{"cutis_look": 1, "' + "x" * 5000 + '": 1}',
        '{"cutis_look": ' + "9" * 4000 + "}",
    ],
)
def test_messages_are_short(text):
    with pytest.raises(CutisError) as error:
        Look.of_text(text, "a.look.json")
    assert len(str(error.value)) < 600
    assert str(error.value).startswith("a.look.json")
