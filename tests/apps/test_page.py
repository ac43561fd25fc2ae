"""The page of the demonstration."""

from pathlib import Path

import pytest
from PIL import Image

from cutis.apps.page import write_page
from cutis.optics import NAMES


@pytest.mark.parametrize("with_colour", [True, False])
def test_it_is_one_file_with_all_in_it(with_colour, tmp_path):
    for name in (*NAMES, "error", "source.preview", "model.preview", "tanned.preview"):
        Image.new("RGB", (4, 4)).save(tmp_path / f"face.{name}.png")
    row = {"unit": "1", "p5": 0.1, "median": 0.2, "p95": 0.3}
    results = {
        "maps": dict.fromkeys(NAMES, row),
        "skin_texels": 12345,
        "calibration": {"gains": [0.9, 1, 1.1], "origin": "auto"},
    }
    if with_colour:
        results["colour"] = {"delta_e_mean": 0.1, "delta_e_p95": 0.3, "out_of_gamut": 0.01}
    write_page(tmp_path / "index.html", Path(tmp_path / "face"), results, "A & B <c>")
    page = (tmp_path / "index.html").read_text("utf-8")
    assert page.count("data:image/png;base64,") == 9
    assert "A &amp; B &lt;c&gt;" in page
    assert "0.900, 1.000, 1.100" in page
    assert ("12,345 skin texels" if with_colour else "No texel inside the mask") in page
    assert 'src="http' not in page
