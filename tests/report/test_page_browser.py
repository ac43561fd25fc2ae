"""The report page as a browser shows it: phone, desk, dark, paper; nothing asked, nothing cut."""

import shutil

import numpy as np
import pytest

from cutis.optics import NAMES
from cutis.report import Report
from cutis.report.page import write_report

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
QUIET = (
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
)  # fmt: skip
CONTRASTS = """() => {
  const channels = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => [r, g, b]
    .map((v) => v / 255).map((v) => v <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [.2126, .7152, .0722][i], 0);
  const ground = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = channels(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  return [...document.body.querySelectorAll("*")]
    .filter((e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()))
    .filter((e) => !["STYLE", "SCRIPT"].includes(e.tagName))
    .map((e) => {
      const [a, b] = [channels(getComputedStyle(e).color), ground(e)].map(luminance);
      return [(Math.max(a, b) + .05) / (Math.min(a, b) + .05), e.textContent.slice(0, 40)];
    });
}"""
"""WCAG contrast ratio of every text against what is behind it."""


@pytest.fixture(scope="module")
def browser():
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="needs playwright: pip install 'cutis[browser]'"
    )
    if CHROMIUM is None:
        pytest.skip("needs a Chromium on the path")
    with sync_api.sync_playwright() as play:
        chromium = play.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    """A page with everything on it, long names and many digits included."""
    noise = np.random.default_rng(1).random
    pictures = {n: noise((96, 64, 3), np.float32) for n in ("capture", "model", "edited")}
    pictures |= {n: 0.01 + 0.2 * noise((96, 64), np.float32) for n in ("error", *NAMES)}
    row = {"unit": "1", "p5": 1.23e-5, "median": 0.0123, "p95": 0.123}
    region = {"texels": 16_384**2, "ita_median": -42.5, "delta_e_mean": 0.123}
    ends = {key: value for key, value in row.items() if key != "unit"}
    region |= {"maps": dict.fromkeys(NAMES, ends)}
    report = {
        "model": "default", "size": [16384, 16384], "masked_texels": 16384**2,
        "skin_texels": 16384**2, "below_0": 123456, "above_1": 123456, "colorspace": "ACEScg",
        "calibration": {"gains": [0.817, 0.861, 1.031], "origin": "auto", "illuminant": "D65"},
        "maps": dict.fromkeys(NAMES, row), "clamped": dict.fromkeys(NAMES, 0.12),
        "smoothness": dict.fromkeys(NAMES, 12.3),
        "colour": {"mse": 1.9e-7, "delta_e_mean": 0.0219, "delta_e_p95": 0.049,
                   "out_of_gamut": 0.25, "ita_median": 28.1},
        "regions": [{"name": n, **region} for n in ("nose", "a_region_" + 9 * "of_long_name")],
    }  # fmt: skip
    path = tmp_path_factory.mktemp("page") / "a.report.html"
    write_report(
        path,
        Report.from_dict(report),
        pictures,
        "a_texture_" + 12 * "with_a_long_name_" + ".1001.exr",
    )
    return path


@pytest.fixture
def open_page(browser, page_file):
    """`open_page(width, …)` shows the page; any request or complaint of it fails the test."""
    contexts, said = [], []

    def show(width, **more):
        contexts.append(browser.new_context(viewport={"width": width, "height": 800}, **more))
        page = contexts[-1].new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url[:99]))
        page.goto(page_file.as_uri())
        return page

    yield show
    for context in contexts:
        context.close()
    assert [line for line in said if not line.startswith(("data:", page_file.as_uri()))] == []


@pytest.mark.parametrize("scripts", [True, False])
@pytest.mark.parametrize("width", [360, 768, 1280])
def test_nothing_is_wider_than_the_screen(width, scripts, open_page):
    page = open_page(width, java_script_enabled=scripts)
    inside = page.locator("h1, h2, p, img, svg, .scroll, .card, .tiles div, figcaption").all()
    boxes = [element.bounding_box() for element in inside]
    assert len(boxes) > 60
    assert all(box["x"] >= 0 and box["x"] + box["width"] <= width for box in boxes if box)
    if scripts:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate("[...document.images].every((i) => i.complete && i.naturalWidth)")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_has_the_contrast_of_wcag_aa(scheme, open_page):
    contrasts = open_page(1280, color_scheme=scheme).evaluate(CONTRASTS)
    assert len(contrasts) > 100
    assert min(contrasts)[0] >= 4.5, min(contrasts)


def test_it_is_dark_where_asked_and_light_on_paper(open_page):
    page = open_page(1280, color_scheme="dark")
    ground = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(ground) == "rgb(22, 20, 18)"
    page.emulate_media(media="print", color_scheme="dark")
    assert page.evaluate(ground) == "rgb(255, 255, 255)"


def test_paper_cuts_nothing_off(open_page):
    page = open_page(1280)
    page.emulate_media(media="print")
    page.set_viewport_size({"width": 688, "height": 1000})  # A4 between margins of 14 mm
    assert page.evaluate("document.documentElement.scrollWidth") <= 688
    assert all(not slider.is_visible() for slider in page.locator("input").all())
    assert page.pdf(format="A4").startswith(b"%PDF")


def test_the_slider_uncovers_the_input_by_keyboard(open_page):
    page = open_page(1280)
    slider, over = page.locator("input").first, page.locator(".compare img + img").first
    clip = "(image) => getComputedStyle(image).clipPath"
    assert page.locator("input").count() == 2
    assert over.evaluate(clip) == "inset(0px 100% 0px 0px)"
    slider.press("End")
    assert over.evaluate(clip).replace("0%", "0px") in ("inset(0px)", "inset(0px 0px 0px 0px)")


@pytest.mark.parametrize("how", ["click", "keyboard"])
def test_pictures_open_large(how, open_page):
    page = open_page(1280)
    dialog, small = page.locator("dialog"), page.locator("img.picture")
    assert small.count() == 12  # two of them lie over others, to be compared
    for name in ("Reconstruction", "melanin map"):
        picture = page.locator(f'main img[alt^="{name}"]')
        before = picture.bounding_box()
        if how == "click":
            picture.click()
        else:
            picture.press("Enter")
        assert dialog.is_visible()
        large = dialog.locator("img")
        assert large.get_attribute("alt").startswith(name)
        assert large.get_attribute("src") == picture.get_attribute("src")
        assert large.bounding_box()["height"] > 1.3 * before["height"]
        page.keyboard.press("Escape")
        assert not dialog.is_visible()
