"""The numbers of a report, worked out again another way."""

import dataclasses

import numpy as np
import pytest
from colour import XYZ_to_Lab
from colour.difference import delta_E_CIE2000

from cutis.colour.spectra import XYZ_TO_SRGB
from cutis.errors import CutisError
from cutis.maps import estimate
from cutis.optics import NAMES, parameter
from cutis.report import report

GAINS = np.array([1.1, 1.0, 0.95])


@pytest.fixture(scope="module")
def skin(face_rgb, face_mask):
    capture = face_rgb.copy()
    capture[8, 8] = (-0.01, 0.2, 0.1)
    capture[9, 9] = (1.2, 0.9, 0.8)
    capture[10, 10] = (0.01, 0.01, 0.01)
    capture[0, 0] = (7, 7, 7)
    return estimate(capture, face_mask, white=tuple(GAINS))


def test_numbers(skin):
    found = report(skin)
    inside = skin.mask > 0
    truth = skin.source[inside] * GAINS
    model = skin.model_albedo[inside] * GAINS
    white = np.array([0.3127, 0.3290])
    to_xyz = np.linalg.inv(XYZ_TO_SRGB).T
    lab, lab_model = (XYZ_to_Lab(rgb @ to_xyz, white) for rgb in (truth, model))
    texels = (lab[:, 0] > 35) & (np.hypot(lab[:, 1], lab[:, 2]) > 12)
    errors = delta_E_CIE2000(lab[texels], lab_model[texels])
    ita = np.degrees(np.arctan2(lab[texels, 0] - 50, lab[texels, 2]))
    assert found["size"] == [24, 32]
    assert found["masked_texels"] == inside.sum() == 16 * 24
    assert found["skin_texels"] == texels.sum() < inside.sum()
    assert (found["below_0"], found["above_1"]) == (1, 1)
    assert found["calibration"] == {
        "gains": list(GAINS),
        "origin": "given",
        "illuminant": "D65",
    }
    assert found["colour"] == {
        "mse": pytest.approx(np.mean((truth - model)[texels] ** 2), rel=1e-3),
        "delta_e_mean": pytest.approx(errors.mean(), rel=1e-3),
        "delta_e_p95": pytest.approx(np.percentile(errors, 95, method="inverted_cdf"), abs=2e-3),
        "out_of_gamut": pytest.approx(np.mean(errors > 1)),
        "ita_median": pytest.approx(np.percentile(ita, 50, method="inverted_cdf"), abs=0.01),
    }
    for name in NAMES:
        values = getattr(skin, name)[inside]
        low, median, high = np.percentile(values, [5, 50, 95], method="inverted_cdf")
        row = found["maps"][name]
        assert row["unit"] == parameter(name).unit
        to_u = parameter(name).to_coordinate
        for key, value in (("p5", low), ("median", median), ("p95", high)):
            assert to_u(row[key]) == pytest.approx(to_u(value), abs=1e-5)
        edges = row["histogram"]["edges"]
        counts = np.histogram(np.clip(values, edges[0], edges[-1]), edges)[0]
        assert np.abs(np.subtract(row["histogram"]["counts"], counts)).sum() <= 4
        ends = to_u(values) * 65536
        assert found["clamped"][name] == np.mean((ends < 1) | (ends >= 65535))


def test_smoothness(skin):
    truth = skin.calibration.apply(skin.source)
    from cutis.colour import is_skin_colour

    where = (skin.mask > 0) & is_skin_colour(truth)
    totals = np.zeros(6)
    columns = [
        parameter(name).to_coordinate(np.maximum(getattr(skin, name), 1e-9)) for name in NAMES
    ]
    for row in range(24):
        for column in range(32):
            for down, right in ((0, 1), (1, 0)):
                r, c = row + down, column + right
                if r < 24 and c < 32 and where[row, column] and where[r, c]:
                    totals[:5] += [abs(values[row, column] - values[r, c]) for values in columns]
                    totals[5] += np.abs(skin.source[row, column] - skin.source[r, c]).mean()
    expected = dict(zip(NAMES, totals[:5] / totals[5], strict=True))
    assert report(skin)["smoothness"] == pytest.approx(expected, rel=1e-4)


def test_bands_do_not_matter(skin, monkeypatch):
    whole = report(skin)
    monkeypatch.setattr("cutis.textures.texture._BAND", 32 * 5)
    banded = report(dataclasses.replace(skin))
    for key in ("colour", "smoothness"):
        assert banded[key] == pytest.approx(whole[key], rel=1e-6)


def test_nothing_of_skin_colour():
    found = report(estimate(np.full((4, 4, 3), (0.05, 0.05, 0.4))))
    assert found["skin_texels"] == 0
    assert "colour" not in found
    assert "smoothness" not in found


def test_a_flat_capture_is_smooth():
    found = report(estimate(np.full((4, 4, 3), (0.5, 0.3, 0.2))))
    assert set(found["smoothness"].values()) == {0.0}


def test_a_report_needs_the_capture(skin):
    with pytest.raises(CutisError, match="needs the capture"):
        report(skin.with_capture(None))
