"""Thresholds are in one file, and a file of one's own overrides what it names."""

import pytest

from cutis.checks import thresholds
from cutis.checks.examine import CHECKS
from cutis.errors import CutisError


def test_every_check_has_thresholds():
    assert {name for name, _ in CHECKS} | {"seams"} == set(thresholds())


def test_overrides(tmp_path):
    path = tmp_path / "ours.toml"
    path.write_text("[clipped]\nfinding = 0.5\n")
    found = thresholds(path)
    assert found["clipped"] == {"note": thresholds()["clipped"]["note"], "finding": 0.5}
    assert thresholds()["clipped"]["finding"] != 0.5


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("[cliped]\nfinding = 1", "no check 'cliped'"),
        ("[clipped]\nfinding = 'a'", "must be a number"),
        ("[clipped]\nlimit = 1", "has no 'limit'"),
        ("clipped = 3", "no check"),
        ("[clipped", "no TOML"),
    ],
)
def test_a_wrong_file(tmp_path, text, what):
    path = tmp_path / "ours.toml"
    path.write_text(text)
    with pytest.raises(CutisError, match=what):
        thresholds(path)
