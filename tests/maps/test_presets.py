"""Presets have the amounts of the paper, or of physiology."""

import pytest

from cutis.errors import CutisError
from cutis.maps import Edit, presets


def multiply(name, factor):
    return (Edit(name, "multiply", factor),)


AMOUNTS = {
    "blood-eighth": multiply("blood", 0.125),
    "blood-half": multiply("blood", 0.5),
    "blood-triple": multiply("blood", 3),
    "melanin-half": multiply("melanin", 0.5),
    "melanin-more": multiply("melanin", 1.5),
    "melanin-triple": multiply("melanin", 3),
    "melanin-fivefold": multiply("melanin", 5),
    "deoxygenated": (Edit("oxygenation", "set", 0.0),),
    "oxygenated": (Edit("oxygenation", "set", 0.999),),
    "thinnest": (Edit("thickness", "set", 10),),
    "thickest": (Edit("thickness", "set", 250),),
    "tanning": (Edit("melanin", "multiply", 1.4), Edit("eumelanin", "set", 0.001)),
    "flushing": (Edit("blood", "multiply", 1.7), Edit("oxygenation", "set", 0.999)),
    "vitiligo": (Edit("melanin", "set", 0.001, "patches"),),
    "jaundice": (Edit("bilirubin", "set", 0.04),),
    "carotenaemia": (Edit("carotene", "set", 0.015),),
    "cyanosis": multiply("oxygenation", 0.4),
    "methaemoglobinaemia": (Edit("methaemoglobin", "set", 0.3),),
}


def test_amounts():
    assert presets.PRESETS == AMOUNTS
    for name, expected in AMOUNTS.items():
        assert presets.preset(name) == expected
        assert getattr(presets, name.replace("-", "_")) == expected


def test_an_unknown_preset_lists_the_known():
    with pytest.raises(CutisError, match=r"unknown preset 'sunburn'; known are .*tanning"):
        presets.preset("sunburn")
