"""The studio as people use it: a real browser, a small face, each tool, and the bytes that come."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.studio.conftest import PROGRAM, start, stop, until

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
FLAGS = (
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
)  # fmt: skip


@pytest.fixture(scope="module")
def browser():
    if os.environ.get("CUTIS_BROWSER") == "required":
        import playwright.sync_api as sync_api
    else:
        sync_api = pytest.importorskip(
            "playwright.sync_api", reason="needs playwright: pip install 'cutis[browser]'"
        )
    if CHROMIUM is None:
        assert os.environ.get("CUTIS_BROWSER") != "required"
        pytest.skip("needs a Chromium on the path")
    with sync_api.sync_playwright() as play:
        chromium = play.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser, running):
    """A window of 1280 × 800 on the small face, maps there, without an error in it."""
    yield from window(browser, running)


def window(browser, running, width=1280, height=800):
    context = browser.new_context(viewport={"width": width, "height": height})
    found = context.new_page()
    wrong, asked = [], []
    found.on("pageerror", lambda error: wrong.append(str(error)))
    found.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
    found.on("request", lambda request: asked.append(request.url))
    found.goto(running.address)
    found.wait_for_selector("body[data-ready]", timeout=60_000)
    yield found
    context.close()
    assert not wrong
    assert all(url.startswith((running.site, f"ws://127.0.0.1:{running.port}", "blob:"))
               for url in asked)  # fmt: skip


def drawn(page, revision=None):
    """Waits until the newest state is on the screen, and gives its revision."""
    page.wait_for_function(
        "before => document.body.dataset.revision !== before"
        " && document.body.dataset.drawn === document.body.dataset.revision",
        arg=revision, timeout=20_000,
    )  # fmt: skip
    return page.evaluate("document.body.dataset.revision")


def colour(page, x=0.5, y=0.5):
    """Mean of 8-bit colours of the canvas around a place, as it is on the screen."""
    return page.evaluate(
        """([x, y]) => {
          const canvas = document.querySelector(".stage canvas");
          const c = document.createElement("canvas");
          c.width = canvas.width; c.height = canvas.height;
          const d = c.getContext("2d");
          d.drawImage(canvas, 0, 0);
          const p = d.getImageData(x * c.width - 10, y * c.height - 10, 20, 20).data;
          const mean = (i) => p.filter((_, k) => k % 4 === i).reduce((a, b) => a + b) / 400;
          return [0, 1, 2].map(mean);
        }""",
        [x, y],
    )


def slide(page, name, value):
    """Types a value beside a slider."""
    row = page.locator(f".row:has(#slider-{name})")
    row.locator(".number").fill(value)
    row.locator(".number").press("Enter")


def test_a_slider_changes_the_skin_undo_and_reload_keep_it(page):
    first = drawn(page)
    before = colour(page)
    slide(page, "melanin", "3")
    second = drawn(page, first)
    dark = colour(page)
    assert sum(dark) < 0.85 * sum(before)
    page.keyboard.press("Control+z")
    third = drawn(page, second)
    assert colour(page) == pytest.approx(before, abs=1.5)
    page.keyboard.press("Control+Shift+z")
    fourth = drawn(page, third)
    assert colour(page) == pytest.approx(dark, abs=1.5)
    page.reload()
    page.wait_for_selector("body[data-ready]")
    drawn(page)
    assert page.locator(".row:has(#slider-melanin) .number").input_value() == "3.00"
    assert colour(page) == pytest.approx(dark, abs=1.5)
    page.keyboard.press("Control+z")
    drawn(page, fourth)


def test_dragging_draws_before_it_is_done(page):
    drawn(page)
    before = colour(page)
    revision = page.evaluate("document.body.dataset.revision")
    box = page.locator("#slider-melanin").bounding_box()
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.9 * box["width"], y, steps=8)
    page.wait_for_function("() => performance.getEntriesByName('slider').length > 0")
    until(lambda: sum(colour(page)) < 0.9 * sum(before))
    assert page.evaluate("document.body.dataset.revision") == revision
    page.mouse.up()
    drawn(page, revision)
    page.keyboard.press("Control+z")


def test_layers_are_added_hidden_renamed_and_removed(page):
    revision = drawn(page)
    page.keyboard.press("n")
    revision = drawn(page, revision)
    items = page.locator(".layers li")
    count = items.count()
    assert count >= 2
    items.first.dblclick()
    page.locator(".layers input").fill("<b>flush</b>")
    page.locator(".layers input").press("Enter")
    revision = drawn(page, revision)
    assert items.first.locator(".name").inner_text() == "<b>flush</b>"
    slide(page, "blood", "3")
    revision = drawn(page, revision)
    red = colour(page)
    page.keyboard.press("h")
    revision = drawn(page, revision)
    plain = colour(page)
    assert red[0] - red[1] > plain[0] - plain[1] + 3
    page.keyboard.press("Delete")
    drawn(page, revision)
    assert items.count() == count - 1


def test_original_split_and_compare(page):
    revision = drawn(page)
    before = colour(page)
    slide(page, "melanin", "4")
    revision = drawn(page, revision)
    after = colour(page)
    page.keyboard.down("\\")
    until(lambda: colour(page) == pytest.approx(before, abs=1.5))
    page.keyboard.up("\\")
    until(lambda: colour(page) == pytest.approx(after, abs=1.5))
    page.get_by_role("button", name="Split").click()
    until(lambda: sum(colour(page, 0.45)) > sum(colour(page, 0.55)) + 30)
    page.keyboard.press("e")
    page.keyboard.press("Control+z")
    drawn(page, revision)


def test_the_pointer_reads_colours_maps_and_spectrum(page):
    drawn(page)
    box = page.locator(".stage canvas").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.wait_for_selector(".card .spectrum")
    text = page.locator(".card").inner_text()
    assert "ITA°" in text
    assert "Melanin" in text
    assert "±" in text


def test_a_brush_paints_a_mask_the_eraser_takes_it_away(page):
    revision = drawn(page)
    page.keyboard.press("n")
    revision = drawn(page, revision)
    slide(page, "melanin", "4")
    revision = drawn(page, revision)
    page.keyboard.press("b")
    box = page.locator(".stage canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def stroke():
        page.mouse.move(x, y - 40)
        page.mouse.down()
        page.mouse.move(x, y + 40, steps=6)
        page.mouse.up()

    everywhere = colour(page, 0.7)
    stroke()
    revision = drawn(page, revision)
    until(lambda: sum(colour(page, 0.7)) > 1.2 * sum(everywhere))
    painted, beside = colour(page), colour(page, 0.7)
    assert sum(painted) < 0.8 * sum(beside)
    assert page.locator(".parts li").inner_text().startswith("Painted, 1")
    page.keyboard.press("m")
    until(lambda: colour(page)[0] > colour(page)[1] + 80)
    page.keyboard.press("m")
    page.keyboard.press("x")
    stroke()
    revision = drawn(page, revision)
    until(lambda: sum(colour(page)) > 1.2 * sum(painted))
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Range").click()
    revision = drawn(page, revision)
    assert page.locator(".parts li").count() == 2
    page.keyboard.press("Delete")
    drawn(page, revision)


def test_maps_have_a_scale_presets_a_picture_the_history_leads_back(page):
    revision = drawn(page)
    for kind in ("map:melanin", "sigma:blood", "confidence:all"):
        page.locator(".kind").select_option(kind)
        page.wait_for_function("() => document.querySelectorAll('.ticks span').length > 1")
    page.locator(".kind").select_option("")
    page.get_by_role("button", name="Presets").click()
    page.wait_for_function("() => document.querySelectorAll('.presets img').length > 12")
    page.get_by_role("button", name="tanning").click()
    revision = drawn(page, revision)
    assert page.locator(".layers li").count() >= 2
    page.get_by_role("button", name="History").click()
    page.wait_for_selector(".history button[aria-current]")
    page.locator(".history button").last.click()
    drawn(page, revision)
    page.get_by_role("button", name="Edit", exact=True).click()
    assert page.locator(".layers li").count() == 1


def test_what_is_saved_is_what_edit_gives(page, running):
    """The bytes of `cutis edit MAPS --look LOOK`, and the source as it was."""
    revision = drawn(page)
    source = (running.folder / "face.png").read_bytes()
    slide(page, "melanin", "1.7")
    revision = drawn(page, revision)
    slide(page, "blood", "0.6")
    drawn(page, revision)
    page.keyboard.press("Control+s")
    page.locator("#save-name").fill("browser test")
    page.get_by_role("button", name="Save albedo").click()
    page.wait_for_selector(".wrote")
    saved = running.folder / "face.browser test.png"
    again = running.folder / "again.png"
    subprocess.run(
        [sys.executable, "-c", PROGRAM, "edit", "face.png.studio/face.skin.exr", "--look",
         "face.browser test.look.json", "-o", "again.png", "-q"],
        cwd=running.folder, check=True,
    )  # fmt: skip
    assert saved.read_bytes() == again.read_bytes()
    assert saved.read_bytes() != source
    assert (running.folder / "face.png").read_bytes() == source
    page.keyboard.press("Escape")


def test_it_can_be_looked_at_on_a_phone(browser, running):
    for page in window(browser, running, 390, 844):
        drawn(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        box = page.locator(".stage").bounding_box()
        assert box["height"] > 350


def test_a_server_that_was_killed_has_every_edit(browser, folder):
    running = start(folder, "face.png")
    try:
        for page in window(browser, running):
            revision = drawn(page)
            slide(page, "thickness", "1.7")
            drawn(page, revision)
    finally:
        running.process.kill()
        stop(running)
    running = start(folder, "face.png")
    try:
        for page in window(browser, running):
            drawn(page)
            assert page.locator(".row:has(#slider-thickness) .number").input_value() == "1.70"
    finally:
        stop(running)
