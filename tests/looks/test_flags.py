"""Looks as flags: what flags can say comes back the same, what they cannot is named."""

import pytest

from cutis.errors import CutisError
from cutis.looks import (
    Blend,
    Contrast,
    Layer,
    Look,
    Multiply,
    Offset,
    PicturePart,
    Set,
    StrokesPart,
    presets,
)
from cutis.maps import parse_edit


def test_numbers_survive():
    edits = (
        Multiply(map="melanin", by=1 / 3), Offset(map="thickness", by=-1e-7),
        Offset(map="blood", by=0.1 + 0.2), Set(map="oxygenation", to=0.123456789),
    )  # fmt: skip
    flags = Look(layers=(Layer(edits=edits),)).as_flags()
    parsed = [
        parse_edit(flag[2:], text) for flag, text in zip(flags[::2], flags[1::2], strict=True)
    ]
    assert Look.of(parsed).layers == (Layer(edits=edits),)


def test_presets_amounts_and_masks():
    assert presets.vitiligo.as_flags() == ("--preset", "vitiligo")
    both = presets.tanning.then(presets.flushing).within(0.25)
    assert both.as_flags() == ("--preset", "tanning", "--preset", "flushing", "--amount", "0.25")
    masked = Look.of([parse_edit("blood", "x2")]).within(1, PicturePart(path="a.png"))
    assert masked.as_flags() == ("--blood", "x2.0", "--mask", "a.png")
    off = Layer(on=False, edits=(Contrast(map="blood", by=2),))
    assert Look(layers=(off,)).as_flags() == ()


ONE = Multiply(map="melanin", by=2)


@pytest.mark.parametrize(
    ("layers", "said"),
    [
        ((Layer(name="even", edits=(Contrast(map="blood", by=0.5),)),),
         r"layer 1 \(even\): no flag says blood contrast x0.5 about the median; save the look"),
        ((Layer(edits=(Blend(map="blood", to=0.1, share=0.5),)),), "layer 1: no flag says"),
        ((Layer(edits=(Multiply(map="blood", by=2, areas="large", radius=0.1),)),), "no flag says"),
        ((Layer(edits=(ONE,)), Layer(edits=(ONE,), amount=0.5)), "one amount and one mask"),
        ((Layer(edits=(ONE,), mask=(StrokesPart(),)),), "masks that are one picture"),
        ((Layer(edits=(ONE,), mask=(PicturePart(path="a.png", invert=True),)),), "one picture"),
        ((Layer(edits=(ONE,), mask=(PicturePart(path="a.png", how="subtract"),)),), "left out"),
    ],
)  # fmt: skip
def test_what_flags_cannot_say_is_named(layers, said):
    with pytest.raises(CutisError, match=said):
        Look(layers=layers).as_flags()
