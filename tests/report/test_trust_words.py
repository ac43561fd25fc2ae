"""What σ says of the maps of one face, in words."""

from dataclasses import replace

import pytest

from cutis.report.numbers import MapNumbers
from cutis.report.trust_words import DARK, ROUGHLY, WELL, known, lines, spread


def maps(informed, melanin=0.02, sigma=0.01):
    rows = {"melanin": melanin, "blood": 0.04, "thickness": 80.0, "oxygenation": 0.7}
    return {
        name: MapNumbers("µm" if name == "thickness" else "1", 0.0, median, 1.0, sigma=sigma,
                         informed=informed)
        for name, median in rows.items()
    }  # fmt: skip


@pytest.mark.parametrize(
    ("informed", "words"),
    [(1.0, "well known"), (WELL, "well known"), (WELL - 0.01, "roughly known"),
     (ROUGHLY, "roughly known"), (ROUGHLY - 0.01, "hardly known"), (0.0, "hardly known")],
)  # fmt: skip
def test_words_follow_what_the_colour_told(informed, words):
    assert known(maps(informed), "blood")[1] == words


def test_blood_below_a_dark_epidermis_is_hidden():
    dark = maps(0.1, melanin=DARK)
    assert known(dark, "blood") == ("doubt", "hidden by melanin on this face")
    assert known(dark, "oxygenation")[1] == "hidden by melanin on this face"
    assert known(dark, "thickness")[1] == "hardly known"
    assert known(maps(0.1, melanin=0.9 * DARK), "blood")[1] == "hardly known"
    assert known(maps(0.5, melanin=DARK), "blood")[1] == "roughly known"


def test_maps_without_sigma_have_no_words():
    plain = {"melanin": MapNumbers("1", 0.01, 0.02, 0.03)}
    assert known(plain, "melanin") is None
    assert known({}, "melanin") is None
    assert list(lines(plain, None)) == []


def test_fractions_are_said_as_shares_of_themselves():
    assert spread(maps(0.9, sigma=0.0016), "melanin") == "±8 %"
    assert spread(maps(0.9, sigma=0.03), "melanin") == "± more than its value"
    assert spread(maps(0.9, sigma=21.7), "thickness") == "±22 µm"
    assert spread(maps(0.9, sigma=0.181), "oxygenation") == "±0.18"


def test_lines():
    said = list(lines(maps(0.9, sigma=0.004), 0.2))
    assert said[0] == "melanin: well known, ±20 %"
    assert said[-1].startswith("20 % of the mask have a colour that is hardly one of skin")
    assert len(list(lines(maps(0.9), 0.01))) == 4


def test_shares_and_darkness_are_of_skin_and_not_of_hair_in_the_mask():
    rows = maps(0.1, melanin=0.5, sigma=0.002)
    rows["melanin"] = replace(rows["melanin"], sure_median=0.02)
    assert spread(rows, "melanin") == "±10 %"
    assert known(rows, "blood")[1] == "hardly known"
