"""Tables of docs/tones.md and docs/images/tones.jpg: faces in other tones.

    python -m studies.tone_accuracy [--model NAME]

11 faces by six tones, the captures like each other, and the swatches of Monk's scale.
"""

import sys

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter

from cutis.colour import delta_e, encode_srgb, ita, lab
from cutis.colour.swatches import MONK, swatch
from cutis.looks.tone import AREAS, LENGTH, nearest_tone
from cutis.looks.tone_path import tone_path
from cutis.maps import DEFAULT, estimate
from studies.generated import ROOT, record
from studies.pages import rewrite
from studies.tone_faces import Tried, tried

TONES = (55, 40, 20, 0, -20, -50)
PICTURE = ROOT / "docs" / "images" / "tones.jpg"
WIDTH = 200
"""Pixels of a face on the sheet."""
Map = NDArray[np.float32]


def areas(values: Map, sure: NDArray[np.bool_]) -> Map:
    """(n, c) values (H, W, c) blurred to 8 mm over where it is surely skin."""
    sigma = max(sure.shape) / LENGTH * AREAS
    weight = sure.astype(float)
    blurred = gaussian_filter(values * weight[..., None], (sigma, sigma, 0))
    return (blurred / np.maximum(gaussian_filter(weight, sigma), 1e-6)[..., None])[sure]


def contrast(face: Tried, colours: Map) -> float:
    """Standard deviation of log RGB of areas, of all three together."""
    logs = np.log(np.maximum(face.seen(colours), 1e-3))
    return float(np.sqrt(areas(logs, face.sure).var(axis=0).sum()))


def redness(face: Tried, colours: Map, where: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Differences (n, 2) of a* and b* of chosen texels to the face's median."""
    found = lab(face.seen(colours))[..., 1:]
    return np.asarray(found[where] - np.median(found[face.sure], axis=0), float)


def reds(face: Tried) -> NDArray[np.bool_]:
    """Where it is red, as lips are: the reddest 2 % of what is surely skin."""
    a = lab(face.seen(face.skin.source))[..., 1]
    return face.sure & (a > np.percentile(a[face.sure], 98))


def turned(before: NDArray[np.float64], after: NDArray[np.float64]) -> float:
    """Degrees by which the median difference turned."""
    one, two = np.median(before, axis=0), np.median(after, axis=0)
    angle = np.degrees(np.arctan2(two[1], two[0]) - np.arctan2(one[1], one[0]))
    return float((angle + 180) % 360 - 180)


def one_face(face: Tried) -> tuple[list[str], list[list[str]], list[Map]]:
    """Its rows, the cells of its sentence, and its pictures."""
    path, source = tone_path(), face.skin.source
    start = float(np.median(ita(face.seen(source[face.sure]))))
    before, red = contrast(face, source), reds(face)
    cells: list[list[str]] = [[], [], [], []]
    pictures = [source]
    for tone in TONES:
        found = face.skin.to_tone(f"ita:{tone}").albedo()
        pictures.append(found)
        got = float(np.median(ita(face.seen(found[face.sure]))))
        measured = path.contrast(tone) / path.contrast(start)
        again = estimate(found, face.skin.mask, white=face.skin.calibration.gains,
                         model=face.skin.model)  # fmt: skip
        kept = float((again.confidence[face.sure] >= 0.5).mean())
        hue = turned(redness(face, source, red), redness(face, found, red))
        cells[0].append(f"{got - tone:+.2f}")
        cells[1].append(f"{contrast(face, found) / before / measured:.2f}")
        cells[2].append(f"{100 * kept:.1f}")
        cells[3].append(f"{hue:+.0f}")
    name = f"{face.name} ({start:.0f})"
    return [f"| {name} | " + " | ".join(row) + " |" for row in cells], cells, pictures


def sheet(rows: list[list[Map]]) -> None:
    """The picture: as captured, then the tones from light to dark."""
    strips = []
    for row in rows:
        wide = row[0].shape[1] > 1.3 * row[0].shape[0]
        cut = (
            slice(int(row[0].shape[1] * 0.26), int(row[0].shape[1] * 0.74)) if wide else slice(None)
        )
        strip = np.concatenate([encode_srgb(np.clip(one[:, cut], 0, 1)) for one in row], axis=1)
        size = WIDTH * len(row), round(strip.shape[0] * WIDTH * len(row) / strip.shape[1])
        image = Image.fromarray(np.uint8(np.rint(255 * strip)))
        strips.append(image.resize(size, Image.Resampling.LANCZOS))
    whole = Image.new("RGB", (strips[0].width, sum(s.height for s in strips)))
    top = 0
    for strip in strips:
        whole.paste(strip, (0, top))
        top += strip.height
    whole.save(PICTURE, quality=85)
    record(PICTURE)
    print(f"wrote {PICTURE}")


def sliced(one: Map, two: Map) -> float:
    """Sliced Wasserstein distance of colours (n, 3) in CIELAB: mean over 64 directions."""
    rng = np.random.default_rng(3)
    directions = rng.normal(size=(64, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    shares = np.linspace(0.005, 0.995, 200)
    a, b = (np.quantile(lab(some) @ directions.T, shares, axis=0) for some in (one, two))
    return float(np.abs(a - b).mean())


def alike(faces: list[Tried]) -> str:
    """Two faces like each other, and back."""
    rows = ["| from | like | median, ΔE00 | distance before | after |", "|---|---|---|---|---|"]
    for one, two in (faces, faces[::-1]):
        target = two.seen(two.skin.source[two.sure])
        own = one.seen(one.skin.source[one.sure])
        found = one.skin.to_tone(two.skin).albedo()
        got = one.seen(found[one.sure])
        apart = delta_e(np.median(got, axis=0), np.median(target, axis=0))
        rows.append(f"| {one.name} | {two.name} | {float(apart):.2f} | {sliced(own, target):.2f} "
                    f"| {sliced(got, target):.2f} |")  # fmt: skip
        again = estimate(found, one.skin.mask, white=one.skin.calibration.gains,
                         model=one.skin.model)  # fmt: skip
        back = one.seen(again.to_tone(one.skin).albedo()[one.sure])
        apart = delta_e(np.median(back, axis=0), np.median(own, axis=0))
        rows.append(f"| that | {one.name} again | {float(apart):.2f} | {sliced(got, own):.2f} "
                    f"| {sliced(back, own):.2f} |")  # fmt: skip
    return "\n".join(rows)


def swatches(face: Tried) -> str:
    """Each swatch: the nearest measured tone, and what the face's median becomes."""
    path = tone_path()
    rows = ["| swatch | its ITA° | nearest measured | ΔE00 of the two | face: ITA° | off by "
            "| ΔE00 to the swatch |", "|---|---|---|---|---|---|---|"]  # fmt: skip
    for number, text in enumerate(MONK, 1):
        colour = swatch(text)
        tone = nearest_tone(path, colour)
        apart = float(delta_e(np.exp(path.colour(tone)), colour))
        found = face.seen(face.skin.to_tone(f"monk:{number}").albedo()[face.sure])
        got = float(np.median(ita(found)))
        left = float(delta_e(np.median(found, axis=0), colour))
        rows.append(f"| monk:{number} | {float(ita(colour)):.0f} | {tone:.0f} | {apart:.1f} "
                    f"| {got:.1f} | {got - tone:+.2f} | {left:.1f} |")  # fmt: skip
    return "\n".join(rows)


def main() -> None:
    model = sys.argv[sys.argv.index("--model") + 1] if "--model" in sys.argv else DEFAULT
    head = "| face (its ITA°) | " + " | ".join(f"{tone}" for tone in TONES) + " |"
    tables = [[head, "|---" * (1 + len(TONES)) + "|"] for _ in range(4)]
    rows, captures = [], []
    for face in tried(model=model):
        lines, _, pictures = one_face(face)
        for table, line in zip(tables, lines, strict=True):
            table.append(line)
        print(*lines, sep="\n", flush=True)
        rows.append(pictures)
        if face.name in ("capture", "scan"):
            captures.append(face)
    sheet(rows)
    error, strength, sure, hue = ("\n".join(table) for table in tables)
    rewrite(
        "tones.md", **{"tones-ita": error, "tones-contrast": strength, "tones-confidence": sure,
        "tones-hue": hue, "tones-like": alike(captures), "tones-monk": swatches(captures[0])},
    )  # fmt: skip


if __name__ == "__main__":
    main()
