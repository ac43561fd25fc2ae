"""What the report page shows, and what it says of it."""

import re

import numpy as np
import pytest

from cutis.optics import NAMES
from cutis.report import Report
from cutis.report.figures import MapFigure, bar_path, colour_figures, map_figures
from cutis.report.numbers import Bars
from cutis.report.scale import Scale


def test_areas_of_a_histogram_are_texels():
    """Also where bins differ in width on the scale, as they do under a root."""
    edges, counts = (0.0, 0.001, 0.027, 0.343, 1.0), (10, 40, 30, 20)
    path = bar_path(Bars(edges, counts), Scale(0, 1, 3))
    steps = re.findall(r"V([\d.]+)H([\d.]+)", path)
    tops, rights = np.array(steps, float).T
    areas = np.diff(rights, prepend=0) * (64 - tops)
    assert areas / areas.sum() == pytest.approx(np.array(counts) / 100, abs=0.005)


MAPS = {
    "melanin": {"unit": "1", "p5": 0.01, "median": 0.02, "p95": 0.03},
    "thickness": {"unit": "µm", "p5": 50.0, "median": 90.0, "p95": 120.0, "sigma": 20.0,
                  "informed": 0.8},
}  # fmt: skip


def test_maps_say_what_they_are_and_how_far_they_are_known():
    rng = np.random.default_rng(0)
    pictures = {"melanin": 0.01 + 0.02 * rng.random((6, 5), np.float32),
                "thickness": 50 + 70 * rng.random((6, 5), np.float32)}  # fmt: skip
    melanin, thickness = map_figures(Report.from_dict({"maps": MAPS}), pictures)
    assert (melanin.level, melanin.tag) == ("good", "RGB fixes it well")
    assert (thickness.level, thickness.tag) == ("good", "well known")
    assert "median 90 µm, 90 % within 50 to 120 µm; ±20 µm each" in thickness.text
    assert "median 0.02, 90 % within 0.01 to 0.03" in melanin.text
    assert thickness.ticks[2].endswith(" µm")
    low, high = thickness.band
    assert 0 <= low < thickness.median < high <= 256
    assert (melanin.picture.width, melanin.picture.height) == (5, 6)


def test_what_is_not_known_is_not_drawn():
    nothing = {**MAPS["melanin"], "p5": np.nan, "median": np.nan, "p95": np.nan}
    report = Report.from_dict({"maps": {"melanin": nothing}})
    [figure] = map_figures(report, {"melanin": np.full((3, 4), np.nan, np.float32)})
    assert figure.band is None
    assert "nan" not in figure.bars


def faces(error: float, share: float) -> dict[str, np.ndarray]:
    """A capture and a model that is off by `error` on a share of the rows."""
    capture = np.full((100, 8, 3), 0.3, np.float32)
    model = capture.copy()
    model[: int(100 * share)] += np.float32(error)
    apart = np.abs(model - capture).sum(axis=2)
    apart[:, 6:] = np.nan
    return {"capture": capture, "model": model, "error": apart}


@pytest.mark.parametrize(
    ("error", "share", "says"),
    [(0.0, 1.0, "black on 100.0"), (0.001, 1.0, "black on 100.0"), (0.1, 0.02, "black on 98.0"),
     (0.1, 0.5, "black is none")],
)  # fmt: skip
def test_a_difference_that_is_black_says_why(error, share, says):
    found = {figure.name: figure for figure in colour_figures(Report(), faces(error, share))}
    assert list(found) == ["Input", "Reconstruction", "Difference × 4", "Colour difference ΔE00"]
    assert says in found["Difference × 4"].text
    assert ("within 3 of 255 steps" in found["Difference × 4"].text) == (share != 0.5)
    assert isinstance(found["Colour difference ΔE00"], MapFigure)


def test_every_map_has_a_figure():
    maps = {name: MAPS["melanin"] for name in NAMES}
    pictures = dict.fromkeys(NAMES, np.full((3, 4), 0.02, np.float32))
    report = Report.from_dict({"maps": maps})
    assert [figure.name for figure in map_figures(report, pictures)] == list(NAMES)
