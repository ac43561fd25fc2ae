"""Writes docs/images/face.jpg: the example capture, what the maps alone give, an edit, the maps."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import cutis
from cutis.maps import SkinMaps
from cutis.optics import PARAMETERS
from cutis.report.appearance import COLOUR_MAPS, displayed
from cutis.report.drawing import Panel, drawn, font
from cutis.report.pictures import reduced
from cutis.report.previews import titled
from cutis.report.scale import Scale
from studies.generated import record

ROOT = Path(__file__).parents[1]
CAPTURE = ROOT / "examples" / "bioskin_capture1.jpg"
TARGET = ROOT / "docs" / "images" / "face.jpg"
HEIGHT, MARGIN, CAPTION = 400, 8, 24
EDIT, EDITED = {"melanin": 2.5, "blood": 0.6}, "melanin × 2.5, blood × 0.6"


def photograph(rgb: np.ndarray, caption: str) -> Image.Image:
    """(H, W, 3) linear sRGB under its caption, HEIGHT pixels high."""
    picture = Image.fromarray(np.uint8(np.rint(255 * displayed(rgb))))
    width = round(picture.width * HEIGHT / picture.height)
    framed = Image.new("RGB", (width, HEIGHT + CAPTION), "white")
    framed.paste(picture.resize((width, HEIGHT), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(framed).text((0, 2), caption, "black", font(14))
    return framed


def maps(skin: SkinMaps) -> list[Image.Image]:
    """The five maps with their scales."""
    found = []
    for known in PARAMETERS:
        values = reduced(np.where(skin.mask > 0, skin.map(known.name), np.nan), HEIGHT)
        low, high = np.nanpercentile(values, [1, 99])
        scale = Scale(float(low), float(high), known.root)
        panel = Panel(values, COLOUR_MAPS[known.name], scale, titled(known.name, known))
        found.append(drawn(panel).convert("RGB"))
    return found


def beside(pictures: list[Image.Image]) -> Image.Image:
    """Pictures in a row."""
    size = sum(p.width + MARGIN for p in pictures) - MARGIN, max(p.height for p in pictures)
    strip, x = Image.new("RGB", size, "white"), 0
    for picture in pictures:
        strip.paste(picture, (x, 0))
        x += picture.width + MARGIN
    return strip


def main() -> None:
    face = cutis.read(CAPTURE)
    mask = cutis.read_mask(CAPTURE.with_name(f"{CAPTURE.stem}_mask.jpg"), face.shape)
    skin = cutis.estimate(face, mask, white="auto")
    albedo = skin.multiply(**EDIT).albedo()
    top = beside([
        photograph(face.linear(), "capture"), photograph(skin.model_albedo, "the maps alone"),
        photograph(albedo, EDITED),
    ])  # fmt: skip
    bottom = beside(maps(skin))
    sheet = Image.new("RGB", (bottom.width, top.height + bottom.height + MARGIN), "white")
    sheet.paste(top, ((bottom.width - top.width) // 2, 0))
    sheet.paste(bottom, (0, top.height + MARGIN))
    sheet.save(TARGET, quality=86)
    record(TARGET)
    print(f"wrote {TARGET.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
