"""A report as a value, to plain data and back."""

import json

import pytest

from cutis.errors import CutisError
from cutis.maps import estimate
from cutis.optics import NAMES
from cutis.report import Regions, Report, RunningReport
from cutis.report.numbers import MapNumbers


@pytest.fixture(scope="module")
def found(face_rgb, tmp_path_factory):
    import numpy as np
    from PIL import Image

    skin = estimate(face_rgb)
    running = RunningReport(skin.model, skin.calibration, skin.shape)
    running.add(skin)
    picture = tmp_path_factory.mktemp("regions") / "regions.png"
    Image.fromarray(np.full((*skin.shape, 3), (255, 0, 0), np.uint8)).save(picture)
    regions = Regions(picture, skin.shape)
    regions.add(skin, slice(0, skin.shape[0]))
    from dataclasses import replace

    return replace(running.finish(), regions=regions.finish(), colorspace="sRGB")


def test_json_and_back_is_the_same_report(found):
    assert Report.from_dict(json.loads(json.dumps(found.as_dict()))) == found


def test_keys_are_those_of_version_0_1(found):
    """What others read from report.json since cutis 0.1."""
    data = found.as_dict()
    assert {
        "model", "size", "masked_texels", "skin_texels", "below_0", "above_1", "calibration",
        "maps", "clamped", "colour", "smoothness", "colorspace", "regions",
    } <= set(data) <= {*data, "low_confidence"}  # fmt: skip
    assert set(data["calibration"]) == {"gains", "origin", "illuminant"}
    assert set(data["colour"]) == {
        "mse", "delta_e_mean", "delta_e_p95", "out_of_gamut", "ita_median"
    }  # fmt: skip
    assert list(data["maps"]) == list(NAMES)
    for row in data["maps"].values():
        assert {"unit", "p5", "median", "p95", "histogram"} <= set(row)
        assert set(row) <= {"unit", "p5", "median", "p95", "histogram", "sigma", "informed",
                            "sure_median"}  # fmt: skip
        assert set(row["histogram"]) == {"edges", "counts"}
    assert set(data["regions"][0]) == {"name", "texels", "ita_median", "delta_e_mean", "maps"}
    assert set(data["regions"][0]["maps"]["blood"]) == {"p5", "median", "p95"}
    assert isinstance(data["size"], list)


def test_what_is_not_known_is_left_out():
    data = Report(maps={"blood": MapNumbers("1", 0.0, 0.1, 0.2)}).as_dict()
    assert data["maps"] == {"blood": {"unit": "1", "p5": 0.0, "median": 0.1, "p95": 0.2}}
    assert not {"colour", "low_confidence", "smoothness", "regions"} & set(data)
    assert data["below_0"] == 0
    assert Report.from_dict(data) == Report.from_dict(Report.from_dict(data).as_dict())


@pytest.mark.parametrize(
    "data",
    [{"colour": {"mse": 1}}, {"maps": []}, {"maps": {"blood": {"unit": "1"}}}, {"surprise": 1},
     {"regions": [{"name": "a"}]}, {"calibration": 3}],
)  # fmt: skip
def test_other_data_is_refused(data):
    with pytest.raises(CutisError, match="no report"):
        Report.from_dict(data)
