"""What the report page says: words that follow from the numbers."""

import math

import pytest

from cutis.optics import NAMES
from cutis.report import Report, findings, summary, words
from cutis.report.numbers import CalibrationNumbers

GOOD = {
    "masked_texels": 1000,
    "skin_texels": 900,
    "calibration": {"gains": [1.0, 1.0, 1.0], "origin": "none", "illuminant": "D65"},
    "colour": {
        "mse": 1e-6,
        "delta_e_mean": 0.02,
        "delta_e_p95": 0.05,
        "out_of_gamut": 0.002,
        "ita_median": 30.0,
    },
}


def changed(**parts):
    """GOOD with some of its parts changed, those that are dicts in part; None takes one away."""
    result = dict(GOOD)
    for key, value in parts.items():
        result[key] = (
            {**result[key], **value} if isinstance(value, dict) and key in result else value
        )
    return Report.from_dict({key: value for key, value in result.items() if value is not None})


def warnings(report):
    """Doubts and cautions besides those that every report has."""
    usual = set(findings.findings(changed()))
    return [f"{level}: {text}" for level, text in findings.findings(report)
            if (level, text) not in usual]  # fmt: skip


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0573569, "0.0574"), (65.29, "65.3"), (1234.5, "1,234"), (-42.5, "−42.5"), (0.0, "0"),
        (1.91e-7, "1.9 × 10⁻⁷"), (-0.0004, "−4.0 × 10⁻⁴"), (None, "–"), (math.nan, "–"),
        (math.inf, "–"),
    ],
)  # fmt: skip
def test_numbers_are_read_at_a_glance(value, text):
    assert words.number(value) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [(0.2544, "25.4 %"), (0.00237, "0.24 %"), (2e-6, "< 0.01 %"), (0.0, "0.00 %"), (None, "–"),
     (math.nan, "–")],
)  # fmt: skip
def test_shares_are_percent(share, text):
    assert words.percent(share) == text.replace(" %", "\u00a0%")


@pytest.mark.parametrize(
    ("ita", "word"),
    [(60, "very light"), (55, "light"), (41.1, "light"), (41, "intermediate"), (28.06,
     "intermediate"), (28, "tan"), (10, "brown"), (-29.9, "brown"), (-30, "dark"), (-80, "dark"),
     (None, "not known"), (math.nan, "not known")],
)  # fmt: skip
def test_categories_are_those_of_chardon(ita, word):
    assert words.category(ita) == word


def test_every_map_has_a_word_on_how_far_rgb_fixes_it():
    assert tuple(findings.FIXED) == NAMES
    assert {level for level, _ in findings.FIXED.values()} == set(words.LEVELS)


ENDS = {"p5": 0.0, "p95": 1.0}
KNOWN = {
    "melanin": {"unit": "1", **ENDS, "median": 0.02, "sigma": 0.0016, "informed": 0.9},
    "blood": {"unit": "1", **ENDS, "median": 0.03, "sigma": 0.01, "informed": 0.5},
    "thickness": {"unit": "µm", **ENDS, "median": 80, "sigma": 21.7, "informed": 0.1},
    "eumelanin": {"unit": "1", **ENDS, "median": 0.7, "sigma": 0.2, "informed": 0.0},
    "oxygenation": {"unit": "1", **ENDS, "median": 0.7},
}


def test_sigma_of_this_face_takes_the_place_of_general_words():
    report = changed(maps=KNOWN)
    assert findings.fixed(report, "melanin") == ("good", "well known")
    assert findings.fixed(report, "oxygenation") == findings.FIXED["oxygenation"]
    said = warnings(report)
    assert [text.split(". ")[0] for text in said] == [
        "good: Melanin: well known, ±8 % (median σ)",
        "care: Blood: roughly known, ±33 % (median σ)",
        "doubt: Thickness: hardly known, ±22 µm (median σ)",
        "doubt: Eumelanin: hardly known, ±0.2 (median σ)",
    ]
    assert "controls for edits, not findings" not in " ".join(said)
    assert "20.0\u00a0% of the mask" in warnings(changed(maps=KNOWN, low_confidence=0.2))[0]
    assert warnings(changed(maps=KNOWN, low_confidence=0.02)) == said


def test_the_verdict_follows_the_share_out_of_gamut():
    said = [findings.verdict(changed(colour={"out_of_gamut": out})) for out in (0.05, 0.1, 0.4)]
    assert said[0].startswith("The model explains this capture")
    assert said[1].startswith("The model explains most of this capture")
    assert said[2].startswith("The model does not explain a large part")
    nothing = changed(colour=None)
    assert "Check the mask and the colour space" in findings.verdict(nothing)
    assert warnings(nothing) == [
        "doubt: Nothing inside the mask looks like skin, so none of the maps can be judged."
    ]


def test_a_good_estimate_is_not_warned_of():
    assert [level for level, _ in findings.findings(changed())] == ["good", "good", "care", "doubt"]


def test_out_of_gamut_asks_for_calibration_or_for_a_tighter_mask():
    off = {"out_of_gamut": 0.25}
    assert "--white auto" in warnings(changed(colour=off))[0]
    [after] = warnings(changed(colour=off, calibration={"origin": "auto"}))
    assert "--white auto" not in after
    assert "make-up" in after


def test_saturated_maps_odd_colours_and_small_skins_are_named():
    assert warnings(changed(clamped={"thickness": 0.049})) == []
    assert "12.0\u00a0% of the thickness map" in warnings(changed(clamped={"thickness": 0.12}))[0]
    assert "30 texels (3.0\u00a0%) have a colour above 1" in warnings(changed(above_1=30))[0]
    assert "1 texels (0.10\u00a0%) have a colour below 0" in warnings(changed(below_0=1))[0]
    assert "Only 10.0\u00a0% of the mask" in warnings(changed(skin_texels=100))[0]


def calibration(*gains, origin="auto", illuminant="D65"):
    found = CalibrationNumbers(gains, origin, illuminant)
    return " ".join(findings.calibration(found))


def test_gains_are_read_as_exposure_and_cast():
    said = calibration(0.817, 0.860, 1.031)
    assert "1.11 times brighter" in said
    assert "red too strong, blue too weak, by a factor of 1.26" in said
    said = calibration(2.0, 2.0, 2.0, origin="given")
    assert "given, not searched for" in said
    assert "2 times darker" in said
    assert "leave its white balance" in said
    assert "keep the brightness" in calibration(1.25, 1.0, 0.8)
    assert "No calibration was asked for" in calibration(1, 1, 1, origin="none")
    assert "from A, its light, to D65" in calibration(1, 1, 1, origin="none", illuminant="A")


def first_step(report):
    return next(findings.next_steps(report, "shots/my face.png", "out/my face.skin.exr"))


def test_the_next_step_follows_from_what_is_wrong():
    maps, face = "'out/my face.skin.exr'", "'shots/my face.png'"
    auto = {"origin": "auto"}
    assert first_step(changed(calibration=auto))[1].startswith(f"cutis edit {maps} ")
    assert first_step(changed())[1] == f"cutis estimate {face} --white auto --again"
    off = changed(colour={"out_of_gamut": 0.3})
    assert first_step(off)[1] == f"cutis estimate {face} --white auto --again"
    tighter = first_step(changed(colour={"out_of_gamut": 0.3}, calibration=auto))
    assert "--mask MASK" in tighter[1]
    assert "highlights" in first_step(changed(calibration=auto, above_1=100))[0]
    commands = [c for _, c in findings.next_steps(changed(colour=None), "a.png", "a.skin.exr") if c]
    assert commands == ["cutis estimate a.png --mask MASK --colorspace sRGB --again"]


def test_the_next_step_repeats_mask_and_folder():
    off = changed(colour={"out_of_gamut": 0.3})
    step = next(findings.next_steps(off, "a.png", "o/a.skin.exr", "my mask.png", "o"))[1]
    assert step == "cutis estimate a.png --mask 'my mask.png' -o o --white auto --again"
    none = [
        c for _, c in findings.next_steps(changed(colour=None), "a.png", "m", "b.png", "o") if c
    ]
    assert none == ["cutis estimate a.png --mask MASK -o o --colorspace sRGB --again"]


def test_steps_are_commands_that_exist(cutis):
    """Every command and flag of every step is one of the command line."""
    reports = [changed(), changed(colour=None), changed(colour={"out_of_gamut": 0.3}),
               changed(colour={"out_of_gamut": 0.3}, calibration={"origin": "auto"})]  # fmt: skip
    steps = {c for r in reports for _, c in findings.next_steps(r, "a.png", "a.skin.exr") if c}
    assert {c.split()[1] for c in steps} == {"estimate", "edit", "render"}
    for command in steps:
        said = cutis(command.split()[1], "--help").out
        assert all(word in said for word in command.split() if word.startswith("-"))


def test_the_summary_says_the_numbers_and_the_next_step():
    report = changed(maps=KNOWN, above_1=30, colorspace="sRGB", calibration={"illuminant": "A"})
    said = [*summary.before(report), *summary.after(report, "a.png", "a.skin.exr")]
    text = "\n".join(said)
    for fact in ("colour space: sRGB", "gains 1.000, 1.000, 1.000 (none)", "captured under A",
                 "30 texels have a colour above one", "900 skin texels", "90.0 % of the mask",
                 "ΔE00 mean 0.020, 95 % 0.050", "out of gamut 0.2 %", "ITA 30°",
                 "melanin: well known, ±8 %"):  # fmt: skip
        assert fact in text
    assert said[-2].startswith("Next: ")
    assert said[-1] == "    cutis estimate a.png --white auto --again"
    assert "RGB fixes melanin" in "\n".join(summary.after(changed(), "a.png", "a.skin.exr"))
    assert summary.line(report) == "ΔE00 0.020, out of gamut 0.20\u00a0%"
    assert summary.line(changed(colour=None)) == "no skin colours"
    assert [row[0] for row in summary.rows(report)] == list(KNOWN)
