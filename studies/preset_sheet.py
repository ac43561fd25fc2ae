"""Table of docs/presets.md and docs/images/presets.jpg: every preset on three faces.

    python -m studies.preset_sheet [--model NAME]

How much the presets change a light, a brown and a dark face, as medians of skin texels where they
do anything: differences of L*, a*, b*.
"""

import sys

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from cutis.colour import encode_srgb, lab
from cutis.looks import presets
from cutis.maps import DEFAULT
from cutis.report.drawing import font
from studies.generated import ROOT, record
from studies.pages import rewrite
from studies.tone_faces import THREE, Tried, tried

OF_THE_PAPER = {
    "blood-eighth", "blood-half", "blood-triple", "deoxygenated", "flushing", "melanin-fivefold",
    "melanin-half", "melanin-more", "melanin-triple", "oxygenated", "tanning", "thickest",
    "thinnest", "vitiligo",
}  # fmt: skip
PICTURE = ROOT / "docs" / "images" / "presets.jpg"
SIZE, ROW, CAPTION = 170, 10, 18
CROP = {"capture": (0.22, 0.9, 0.1, 0.95)}
"""Top, bottom, left and right of what is shown; of the others the middle half."""


def expected() -> tuple[str, ...]:
    """Presets that are not of the paper."""
    return tuple(name for name in presets.names() if name not in OF_THE_PAPER)


def difference(face: Tried, name: str) -> tuple[NDArray[np.float64], float, NDArray[np.float32]]:
    """Medians (3,) of ΔL*, Δa*, Δb* where a preset moves a texel by 0.5, that share, the result."""
    assert face.skin.source is not None
    found = face.skin.apply(presets.preset(name)).albedo()
    both = [lab(face.seen(one[face.sure])) for one in (face.skin.source, found)]
    moved = np.asarray(both[1] - both[0], float)
    there = np.abs(moved).max(axis=1) > 0.5
    middle = np.median(moved[there], axis=0) if there.any() else np.zeros(3)
    return middle, float(there.mean()), found


def tile(face: Tried, colours: NDArray[np.float32], caption: str) -> Image.Image:
    """A face under its caption."""
    high, wide = colours.shape[:2]
    top, bottom, left, right = CROP.get(face.name, (0.0, 1.0, 0.26, 0.74))
    part = colours[int(top * high) : int(bottom * high), int(left * wide) : int(right * wide)]
    picture = Image.fromarray(np.uint8(np.rint(255 * encode_srgb(np.clip(part, 0, 1)))))
    framed = Image.new("RGB", (SIZE, SIZE + CAPTION), "white")
    framed.paste(picture.resize((SIZE, SIZE), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(framed).text((2, 1), caption, "black", font(12))
    return framed


def main() -> None:
    model = sys.argv[sys.argv.index("--model") + 1] if "--model" in sys.argv else DEFAULT
    names = expected()
    rows: dict[str, list[str]] = {name: [] for name in names}
    tiles: list[list[Image.Image]] = []
    for face in tried(THREE, model):
        assert face.skin.source is not None
        shown = [tile(face, face.skin.source, face.name)]
        for name in names:
            middle, share, found = difference(face, name)
            numbers = ", ".join(f"{v:+.1f}" for v in middle)
            rows[name].append(f"{numbers} ({100 * share:.0f} %)")
            shown.append(tile(face, found, name))
        tiles.append(shown)
    columns = ROW
    blocks = -(-len(tiles[0]) // columns)
    whole = Image.new("RGB", (columns * SIZE, 3 * blocks * (SIZE + CAPTION)), "white")
    for at, shown in enumerate(tiles):
        for i, one in enumerate(shown):
            block, column = divmod(i, columns)
            whole.paste(one, (column * SIZE, (3 * block + at) * (SIZE + CAPTION)))
    whole.save(PICTURE, quality=85)
    record(PICTURE)
    lines = ["| preset | light: ΔL\\*, Δa\\*, Δb\\* (share of the skin) | brown | dark |",
             "|---|---|---|---|"]  # fmt: skip
    lines += [f"| `{name}` | " + " | ".join(cells) + " |" for name, cells in rows.items()]
    rewrite("presets.md", presets="\n".join(lines))


if __name__ == "__main__":
    main()
