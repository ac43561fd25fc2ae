"""Screenshots of the studio for docs/studio.md: light, brown and dark faces, its main states.

    python -m studies.studio_pictures

Needs a Chromium on the path and `cutis[browser,studio]`. Shows the bundled capture and albedos of
the bundled heads. Writes docs/studio/*.jpg.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
HEADS = ROOT / "src" / "cutis" / "data" / "heads"
OUTPUT = ROOT / "docs" / "studio"
FLAGS = (
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
)  # fmt: skip
FACES = {
    "light": ROOT / "examples" / "bioskin_capture1.jpg",
    "brown": HEADS / "makehuman_african_middleage_mindfront.jpg",
    "dark": HEADS / "makehuman_young_dark_male.jpg",
}
PROGRAM = "from cutis.apps.main import main; main()"


def main() -> None:
    from playwright.sync_api import sync_playwright

    OUTPUT.mkdir(exist_ok=True)
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        for name, path in FACES.items():
            shutil.copy(path, Path(folder) / f"{name}.jpg")
        browser = play.chromium.launch(executable_path=chromium, args=list(FLAGS))
        for name in FACES:
            _shoot(browser, Path(folder), name)
        browser.close()


def _shoot(browser: Any, folder: Path, name: str) -> None:
    white = ["--white", "auto"] if name == "light" else []
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, "studio", f"{name}.jpg", "--no-browser", *white],
        cwd=folder, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    try:
        address = process.stdout.readline().strip()
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(address)
        page.wait_for_selector("body[data-ready]", timeout=600_000)
        {"light": _sliders, "brown": _brush, "dark": _split}[name](page)
        page.wait_for_timeout(2500)
        page.screenshot(path=OUTPUT / f"{name}.jpg", quality=88, type="jpeg")
        if name == "light":
            page.locator(".kind").select_option("map:melanin")
            page.get_by_role("button", name="Presets").click()
            page.wait_for_timeout(8000)
            page.screenshot(path=OUTPUT / "presets.jpg", quality=88, type="jpeg")
            page.set_viewport_size({"width": 390, "height": 844})
            page.locator(".kind").select_option("")
            page.get_by_role("button", name="Edit", exact=True).click()
            page.keyboard.press("0")
            page.wait_for_timeout(2500)
            page.screenshot(path=OUTPUT / "phone.jpg", quality=88, type="jpeg")
        page.close()
    finally:
        process.terminate()
        process.wait()
        process.stdout.close()


def _typed(page: Any, name: str, value: str) -> None:
    row = page.locator(f".row:has(#slider-{name}) .number")
    row.fill(value)
    row.press("Enter")
    page.wait_for_timeout(600)


def _centre(page: Any) -> tuple[float, float]:
    box = page.locator(".stage canvas").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def _sliders(page: Any) -> None:
    _typed(page, "melanin", "1.6")
    _typed(page, "blood", "1.2")
    x, y = _centre(page)
    page.mouse.move(x + 20, y - 60)


def _brush(page: Any) -> None:
    page.keyboard.press("n")
    page.wait_for_timeout(600)
    _typed(page, "blood", "3")
    page.keyboard.press("b")
    x, y = _centre(page)
    for side in (-60, 60):
        page.mouse.move(x + side, y + 10)
        page.mouse.down()
        page.mouse.move(x + side * 1.3, y + 40, steps=8)
        page.mouse.up()
        page.wait_for_timeout(500)
    page.keyboard.press("m")


def _split(page: Any) -> None:
    _typed(page, "melanin", "0.4")
    page.keyboard.press("s")


if __name__ == "__main__":
    main()
