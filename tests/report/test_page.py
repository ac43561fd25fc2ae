"""The report page: one safe, whole file that shows every number it is given."""

import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.optics import NAMES
from cutis.report import Report
from cutis.report.page import write_report

VOID = {"meta", "link", "img", "input", "br"}


class Page(HTMLParser):
    """A page taken apart: its tags, words and headings; fails where tags do not match."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open, self.headings, self.words = [], [], [], ""
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))

    def handle_startendtag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not {"style", "script"} & set(self.open):
            self.words += data

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture
def report():
    """A report with everything in it; every number differs from all others."""
    row = lambda i: {"p5": 0.011 * i, "median": 0.0123 * i, "p95": 0.0157 * i}  # noqa: E731
    edges = np.linspace(0.01, 0.3, 65).tolist()
    return {
        "model": "default",
        "size": [48, 32],
        "masked_texels": 1500,
        "skin_texels": 1234,
        "below_0": 17,
        "above_1": 19,
        "colorspace": "sRGB (assumed: the file says nothing)",
        "calibration": {"gains": [0.817, 0.861, 1.031], "origin": "auto", "illuminant": "D65"},
        "maps": {
            name: {"unit": "1", **row(i), "histogram": {"edges": edges, "counts": [i] * 64}}
            for i, name in enumerate(NAMES, 2)
        },
        "clamped": {name: 0.0612 + 0.01 * i for i, name in enumerate(NAMES)},
        "colour": {
            "mse": 1.9e-7,
            "delta_e_mean": 0.219,
            "delta_e_p95": 0.491,
            "out_of_gamut": 0.0237,
            "ita_median": 28.4,
        },
        "smoothness": {name: 1.61 + i for i, name in enumerate(NAMES)},
        "regions": [
            {
                "name": f"region {i}",
                "texels": 333 + i,
                "ita_median": -42.5 + i,
                "delta_e_mean": 0.71 + 0.02 * i,
                "maps": {name: row(7 * i + j) for j, name in enumerate(NAMES, 8)},
            }
            for i in (0, 1)
        ],
    }


@pytest.fixture
def pictures():
    """All pictures, 48 × 32, half of them outside the mask."""
    noise = np.random.default_rng(1).random
    colours = {n: noise((48, 32, 3), np.float32) for n in ("capture", "model", "edited")}
    maps = {n: 0.01 + 0.2 * noise((48, 32), np.float32) for n in ("error", *NAMES)}
    for values in maps.values():
        values[:, 16:] = np.nan
    return colours | maps


@pytest.fixture
def write(tmp_path):
    def run(report, *arguments, **more):
        path = tmp_path / "face.report.html"
        write_report(path, Report.from_dict(report), *arguments, **more)
        text = path.read_text("utf-8")
        return text, Page(text)

    return run


def leaves(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for part in value:
            yield from leaves(part)
    elif not isinstance(value, str):
        yield value


def test_it_asks_for_nothing_from_outside(write, report, pictures):
    text, page = write(report, pictures, "face.png")
    assert len(page.all("img")) == 16  # five colours, ΔE00 and five maps with a strip each
    assert all(image["src"].startswith("data:image/") for image in page.all("img"))
    assert [link["href"] for link in page.all("link")] == ["data:,"]
    assert not any(set(attributes) & {"srcset", "action"} for _, attributes in page.tags)
    assert not re.search(r"(?i)https?:|url\(|@import|//[a-z]+\.", text)
    policy = next(m["content"] for m in page.all("meta") if "http-equiv" in m)
    assert policy.startswith("default-src 'none'; img-src data:;")


def test_sigma_is_on_it_where_the_model_knows_it(write, report, pictures):
    for i, name in enumerate(NAMES):
        report["maps"][name] |= {"sigma": 0.00123 * (i + 1), "informed": 0.871 - 0.2 * i}
    _, page = write(report, pictures, "face.png")
    for i in range(5):
        assert f"{0.00123 * (i + 1):.3g}" in page.words
        assert f"{87.1 - 20 * i:.1f}\u00a0%" in page.words
    assert "well known" in page.words
    assert "RGB fixes it" not in page.words


def test_every_number_of_the_report_is_on_it(write, report, pictures):
    _, page = write(report, pictures, "face.png")
    maps = {k: {q: v[q] for q in ("p5", "median", "p95")} for k, v in report["maps"].items()}
    numbers = [*leaves(maps), *leaves(report["smoothness"]), *leaves(report["regions"])]
    numbers += [report["colour"][k] for k in ("delta_e_mean", "delta_e_p95", "ita_median")]
    assert len(numbers) == 15 + 5 + 2 * 18 + 3
    for value in numbers:
        assert f"{value:.3g}".replace("-", "−") in page.words
    clamped = [f"{100 * share:.1f}\u00a0%" for share in report["clamped"].values()]
    for text in (
        "0.817", "0.861", "1.031", "1.9 × 10⁻⁷", "2.4\u00a0%", "17 texels", "19 texels", "32 × 48",
        "1,500", "1,234", "333", "334", report["colorspace"], "model default", "region 0",
        "region 1", *clamped,
    ):  # fmt: skip
        assert text in page.words


def test_headings_go_down_one_at_a_time_and_pictures_say_what_they_are(write, report, pictures):
    text, page = write(report, pictures, "face.png")
    assert page.headings[0] == 1
    assert page.headings.count(1) == 1
    assert max(np.diff(page.headings)) == 1
    alts = [image["alt"] for image in page.all("img")]
    assert len(set(alts) - {""}) == 10
    assert all(figure["aria-label"] for figure in page.all("svg"))
    assert '<html lang="en">' in text


def test_names_of_files_and_regions_are_words_and_nothing_else(write, report, pictures):
    odd = "<script>alert(\"1\")</script> & 'x'.png"
    report["regions"][0]["name"] = report["colorspace"] = report["model"] = odd
    report["calibration"]["illuminant"] = odd
    text, page = write(report, pictures, odd, notes=[odd, "A & B <c>"])
    assert page.words.count(odd) == 7
    assert "A & B <c>" in page.words
    assert "<script>alert" not in text
    assert len(page.all("script")) == 1


def test_what_to_do_next_comes_last(write, report, pictures):
    text, page = write(report, pictures, "my face.png")
    assert "cutis edit 'my face.skin.exr' --melanin" in page.words
    after = text[text.index("<h2>What to do next</h2>") :]
    assert "<h2>" not in after[10:]


@pytest.mark.parametrize(
    "absent",
    ["colour", "regions", "clamped", "smoothness", "calibration", "colorspace", "maps", "size"],
)
def test_what_a_report_lacks_is_left_out(absent, write, report, pictures):
    del report[absent]
    _, page = write(report, pictures, "face.png")
    assert "nan" not in page.words.lower().split()
    assert "None" not in page.words


@pytest.mark.parametrize("absent", ["capture", "model", "edited", "error", "melanin"])
def test_pictures_that_are_missing_are_left_out(absent, write, report, pictures):
    every = write(report, pictures, "face.png")[1].all("img")
    del pictures[absent]
    fewer = write(report, pictures, "face.png")[1].all("img")
    lost = {"capture": 2, "model": 2, "error": 2, "melanin": 2, "edited": 1}  # × 4, strips
    assert len(every) - len(fewer) == lost[absent]


def test_without_histograms_those_of_the_pictures_are_drawn(write, report, pictures):
    for row in report["maps"].values():
        del row["histogram"]
    _, page = write(report, pictures, "face.png")
    assert len(page.all("svg")) == 6


@pytest.mark.parametrize("shape", [(1, 1), (1, 900), (900, 1)])
def test_tiny_and_thin_textures_have_a_page(shape, write, report):
    pictures = {n: np.ones((*shape, 3), np.float32) for n in ("capture", "model")}
    pictures |= {n: np.full(shape, 0.02, np.float32) for n in ("error", *NAMES)}
    write(report, pictures, "face.png")


def test_pictures_without_a_known_texel_have_a_page(write, report):
    pictures = {n: np.full((9, 7), np.nan, np.float32) for n in ("error", *NAMES)}
    pictures["capture"] = np.full((9, 7, 3), np.nan, np.float32)
    for row in report["maps"].values():
        row |= dict.fromkeys(("p5", "median", "p95"), math.nan)
        row["histogram"]["counts"] = [0] * 64
    _, page = write(report, pictures, "face.png")
    assert "nan" not in page.words.lower().split()


def test_a_page_of_noise_stays_below_three_megabytes(write, report):
    noise = np.random.default_rng(2).random
    pictures = {n: noise((900, 900, 3), np.float32) for n in ("capture", "model", "edited")}
    pictures |= {n: noise((900, 900), np.float32) for n in ("error", *NAMES)}
    text, _ = write(report, pictures, "noise.png")
    assert 1_000_000 < len(text.encode()) < 3_000_000


def test_a_folder_that_is_not_there_is_named(report, pictures, tmp_path):
    with pytest.raises(CutisError, match="does not exist"):
        write_report(tmp_path / "no" / "page.html", Report.from_dict(report), pictures, "face.png")
