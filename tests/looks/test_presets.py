"""Presets have the amounts of the paper, or of physiology."""

import pytest

from cutis.errors import CutisError
from cutis.looks import Look, presets
from cutis.maps import Edit


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
    for name, expected in AMOUNTS.items():
        found = presets.preset(name)
        assert found.name == name
        assert found.note
        assert found.layers == Look.of(expected).layers
        assert getattr(presets, name.replace("-", "_")) is found


def test_an_unknown_preset_lists_the_known():
    with pytest.raises(CutisError, match=r"unknown preset 'kelp'; known are .*tanning"):
        presets.preset("kelp")
    with pytest.raises(CutisError, match=r"did you mean flushing\?"):
        presets.preset("flushin")
    with pytest.raises(AttributeError):
        _ = presets.kelp


def test_all_are_listed():
    assert set(AMOUNTS) <= set(presets.names())
    assert {name.replace("-", "_") for name in presets.names()} <= set(dir(presets))
    for name in presets.names():
        assert presets.preset(name).note, f"{name} does not say where its amounts are from"
