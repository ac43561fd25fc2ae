"""Writes docs/images/face.jpg from the previews of `make demo`: run it, then this."""

from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).parents[1]
STEM = ROOT / "demo" / "bioskin_capture1"
HEIGHT, MARGIN, CAPTION = 380, 8, 22
ROWS = [
    {"source.preview": "capture", "model.preview": "model alone", "tanned.preview": "tanned"},
    {
        "melanin": "melanin",
        "blood": "blood",
        "thickness": "thickness",
        "eumelanin": "eumelanin",
        "oxygenation": "oxygenation",
    },
]


def row(pictures: dict[str, str], width: int | None) -> Image.Image:
    """Pictures side by side with captions, scaled to `width` when given."""
    font = ImageFont.load_default(15)
    tiles = []
    for name, caption in pictures.items():
        tile = Image.open(f"{STEM}.{name}.png").convert("RGB")
        tile = tile.resize((round(tile.width * HEIGHT / tile.height), HEIGHT), Image.LANCZOS)
        framed = Image.new("RGB", (tile.width + MARGIN, HEIGHT + CAPTION), "white")
        framed.paste(tile, (0, CAPTION))
        ImageDraw.Draw(framed).text((2, 2), caption, "black", font)
        tiles.append(framed)
    strip = Image.new("RGB", (sum(t.width for t in tiles), HEIGHT + CAPTION), "white")
    x = 0
    for tile in tiles:
        strip.paste(tile, (x, 0))
        x += tile.width
    if width is None:
        return strip
    return strip.resize((width, round(strip.height * width / strip.width)), Image.LANCZOS)


def main() -> None:
    bottom = row(ROWS[1], None)
    top = row(ROWS[0], None)
    sheet = Image.new("RGB", (bottom.width, top.height + bottom.height), "white")
    sheet.paste(top, ((bottom.width - top.width) // 2, 0))
    sheet.paste(bottom, (0, top.height))
    target = ROOT / "docs" / "images" / "face.jpg"
    target.parent.mkdir(exist_ok=True)
    sheet.save(target, quality=85)
    print(f"wrote {target.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
