"""Writes the table of docs/checks.md: faults made on purpose on three faces, and what is found.

Each fault has three strengths. The mark says from which of them on somebody is taken to see it; it
is a judgement, no experiment. Thresholds were set on these same faces: the table is a fit and no
proof on others.
"""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from cutis.colour import LINEAR, SRGB, encode_srgb
from cutis.colour.transfer import decode_srgb
from cutis.jobs.check import Checked, CheckJob
from cutis.jobs.outcome import CaptureFiles
from cutis.textures import Texture, read_mask, read_texture, write_texture
from studies.generated import SHARED
from studies.pages import rewrite

ALBEDO = SHARED / "albedo"
FACES = {
    "light": ("reom_light_face.jpg", None),
    "brown": ("makehuman_old_light_male2_head.png", "makehuman_head_mask.png"),
    "dark": ("reom_dark_face.jpg", None),
}
SIDE = 512
"""Texels that faces are reduced to, at most."""


@dataclass(frozen=True)
class Fault:
    """A fault: what people call it, the kinds that count as found, its strengths in words.

    `seen` is the number of the first strength that an eye sees, `make` takes the face, its mask,
    the folder and the number of a strength, and gives the files of texture and mask.
    """

    name: str
    kinds: tuple[str, ...]
    strengths: tuple[str, str, str]
    seen: int
    make: Callable[[np.ndarray, np.ndarray, Path, int], tuple[Path, Path]]


def written(path: Path, rgb: np.ndarray, dtype: str = "uint8") -> Path:
    """A texture of linear sRGB; floats are written as they are, and labelled linear."""
    space = LINEAR if dtype.startswith("f") else SRGB
    blank = Texture(np.zeros(rgb.shape, dtype), ("R", "G", "B"), space)
    everywhere = np.ones(rgb.shape[:2], bool)
    write_texture(blank.with_linear(rgb.astype(np.float32), everywhere), path, space)
    return path


def masked(folder: Path, mask: np.ndarray) -> Path:
    return written(folder / "mask.png", np.repeat(mask[..., None], 3, axis=-1))


def changed(how: Callable[[np.ndarray, int], np.ndarray], dtype: str = "uint8") -> Callable:
    """A fault of colours alone."""

    def make(rgb: np.ndarray, mask: np.ndarray, folder: Path, k: int) -> tuple[Path, Path]:
        end = ".exr" if dtype.startswith("f") else ".png"
        return written(folder / f"face{end}", how(rgb, k), dtype), masked(folder, mask)

    return make


def gains(*strengths: tuple[float, float, float]) -> Callable:
    return changed(lambda rgb, k: (rgb * np.array(strengths[k])).clip(0, 1))


def slope(axis: int) -> Callable:
    """Light that falls off across the picture, by 20, 40 and 60 %."""

    def how(rgb: np.ndarray, k: int) -> np.ndarray:
        line = np.linspace(1, 1 - (0.2, 0.4, 0.6)[k], rgb.shape[axis])
        return rgb * (line[:, None, None] if axis == 0 else line[None, :, None])

    return changed(how)


def shine(rgb: np.ndarray, k: int) -> np.ndarray:
    """White light of 0.1, 0.2, 0.4 on forehead, nose and cheeks."""
    height, width = rgb.shape[:2]
    y, x = np.mgrid[:height, :width]
    spots = ((0.3, 0.5), (0.45, 0.5), (0.5, 0.4), (0.5, 0.6))
    light = sum(
        np.exp(-((y - r * height) ** 2 + (x - c * width) ** 2) / (2 * (0.03 * width) ** 2))
        for r, c in spots
    )
    return (rgb + (0.1, 0.2, 0.4)[k] * light[..., None]).clip(0, 1)


def codes(rgb: np.ndarray, count: int) -> np.ndarray:
    """Colours with so many steps from black to white, as shown."""
    return np.asarray(decode_srgb(np.rint(encode_srgb(rgb.clip(0, 1)) * count) / count))


def jpeg(rgb: np.ndarray, mask: np.ndarray, folder: Path, k: int) -> tuple[Path, Path]:
    stored = np.uint8(np.rint(255 * encode_srgb(rgb.clip(0, 1))))
    Image.fromarray(stored).save(folder / "face.jpg", quality=(60, 35, 15)[k])
    return folder / "face.jpg", masked(folder, mask)


def smooth(rgb: np.ndarray) -> np.ndarray:
    """Means of 2 × 2 texels, which lie between the steps of 8 bits."""
    h, w = rgb.shape[0] // 2 * 2, rgb.shape[1] // 2 * 2
    return rgb[:h, :w].reshape(h // 2, 2, w // 2, 2, 3).mean(axis=(1, 3))


def encoded(rgb: np.ndarray, mask: np.ndarray, folder: Path, k: int) -> tuple[Path, Path]:
    """Encoded values labelled linear: float of 8-bit codes, half of them, float after a resize."""
    if k == 2:
        rgb, mask = smooth(rgb), mask[::2, ::2][: rgb.shape[0] // 2, : rgb.shape[1] // 2]
        values = np.asarray(encode_srgb(rgb))
    else:
        values = np.rint(255 * encode_srgb(rgb.clip(0, 1))) / 255
    return (
        written(folder / "face.exr", values, ("float32", "float16", "float32")[k]),
        masked(folder, mask),
    )


def turned_over(rgb: np.ndarray, mask: np.ndarray, folder: Path, k: int) -> tuple[Path, Path]:
    """A mask that is black on skin; faces without one get an oval."""
    if mask.all():
        height, width = mask.shape
        y, x = np.mgrid[:height, :width]
        mask = ((y / height - 0.5) / 0.45) ** 2 + ((x / width - 0.5) / 0.35) ** 2 < 1
        rgb = np.where(mask[..., None], rgb, (0.02, 0.03, 0.05))
    return written(folder / "face.png", rgb), masked(folder, 1.0 - mask.astype(np.float64))


FAULTS = (
    Fault("encoded, labelled linear", ("colour-space",),
          ("float codes", "half codes", "float, resized"), 0, encoded),
    Fault("linear, labelled sRGB", ("colour-space",), ("8 bits", "16 bits", "16 bits, × 1.2"), 0,
          lambda rgb, mask, folder, k: (
              written(folder / "face.png", decode_srgb((rgb * (1, 1, 1.2)[k]).clip(0, 1)),
                      ("uint8", "uint16", "uint16")[k]), masked(folder, mask))),
    Fault("floats of codes", ("scale",), ("0–255", "0–1023", "0–65535"), 0,
          changed(lambda rgb, k: (255, 1023, 65535)[k] * np.asarray(encode_srgb(rgb)), "float32")),
    Fault("too bright", ("exposure", "clipped"), ("× 1.3", "× 1.8", "× 2.5"), 1,
          gains((1.3,) * 3, (1.8,) * 3, (2.5,) * 3)),
    Fault("too dark", ("exposure", "colour-space"), ("× 0.5", "× 0.2", "× 0.05"), 1,
          changed(lambda rgb, k: (0.5, 0.2, 0.05)[k] * rgb, "uint16")),
    Fault("warm cast", ("cast", "clipped"), ("1.1, 1, 0.9", "1.2, 1, 0.75", "1.3, 1, 0.55"), 1,
          gains((1.1, 1, 0.9), (1.2, 1, 0.75), (1.3, 1, 0.55))),
    Fault("cold cast", ("cast",), ("0.9, 1, 1.15", "0.75, 1, 1.4", "0.6, 1, 1.7"), 1,
          gains((0.9, 1, 1.15), (0.75, 1, 1.4), (0.6, 1, 1.7))),
    Fault("green cast", ("cast",), ("green × 1.08", "green × 1.2", "green × 1.35"), 1,
          gains((1, 1.08, 1), (1, 1.2, 1), (1, 1.35, 1))),
    Fault("light from one side", ("baked-light",), ("20 %", "40 %", "60 %"), 1, slope(1)),
    Fault("light from above", ("baked-light",), ("20 %", "40 %", "60 %"), 1, slope(0)),
    Fault("highlights", ("gloss", "clipped"), ("0.1", "0.2", "0.4"), 1, changed(shine)),
    Fault("clipped", ("clipped", "exposure"), ("0.1 %", "2 %", "20 %"), 1,
          changed(lambda rgb, k: rgb / np.percentile(rgb[..., 0], (99.9, 98, 80)[k]))),
    Fault("crushed", ("crushed",), ("1 %", "6 %", "25 %"), 1,
          changed(lambda rgb, k: rgb - np.percentile(rgb[..., 2], (1, 6, 25)[k]))),
    Fault("few codes", ("banding",), ("128", "64", "32"), 1,
          changed(lambda rgb, k: codes(rgb, (128, 64, 32)[k]))),
    Fault("JPEG quality", ("jpeg-blocks",), ("60", "35", "15"), 1, jpeg),
    Fault("inverted mask", ("mask-inverted",), ("yes", "yes", "yes"), 0, turned_over),
)  # fmt: skip
MARKS = {"finding": "●", "note": "○", None: "–"}


def face(name: str, mask: str | None) -> tuple[np.ndarray, np.ndarray]:
    """Linear sRGB (H, W, 3) and mask (H, W) of a face, reduced by leaving texels out."""
    texture = read_texture(ALBEDO / name)
    cover = np.ones(texture.shape) if mask is None else read_mask(ALBEDO / mask, texture.frame)
    step = max(1, max(texture.shape) // SIDE)
    return texture.linear()[::step, ::step].astype(np.float64), cover[::step, ::step] > 0.5


def level(found: Checked, kinds: tuple[str, ...]) -> str | None:
    """The worst level at which one of the kinds was found."""
    assert found.failure is None, found.failure
    levels = {one.level for one in found.findings if one.kind in kinds}
    return next((one for one in ("finding", "note") if one in levels), None)


def checked(files: tuple[Path, Path]) -> Checked:
    (found,) = CheckJob((CaptureFiles(*files),)).run()
    return found


def main() -> None:
    every = {name: face(*files) for name, files in FACES.items()}
    lines = [
        "| fault | strengths | seen from | " + " | ".join(FACES) + " | findings + notes |",
        "|---|---|---|" + "---|" * (len(FACES) + 1),
    ]
    with tempfile.TemporaryDirectory() as folder:
        for fault in FAULTS:
            marks: dict[str, list[str | None]] = {}
            for name, (rgb, mask) in every.items():
                marks[name] = [
                    level(checked(fault.make(rgb, mask, Path(folder), k)), fault.kinds)
                    for k in range(3)
                ]
            shown = [" ".join(MARKS[one] for one in marks[name]) for name in FACES]
            counts = [
                f"{sum(row[k] == 'finding' for row in marks.values())}"
                f" + {sum(row[k] == 'note' for row in marks.values())}"
                for k in range(3)
            ]
            cells = [fault.name, "; ".join(fault.strengths), fault.strengths[fault.seen], *shown]
            lines.append(f"| {' | '.join(cells)} | {'; '.join(counts)} |")
            print(lines[-1], flush=True)
    clean = ["| texture | as it is | findings | notes |", "|---|---|---|---|"]
    clean += list(as_they_are())
    rewrite("checks.md", faults="\n".join(lines), clean="\n".join(clean))


def as_they_are() -> list[str]:
    """A row for each texture of the larger data, with its mask where it has one."""
    rows = []
    for path in sorted(ALBEDO.glob("*.[jp][pn]g")):
        if path.stem.endswith("mask"):
            continue
        mask = ALBEDO / {"m": "makehuman_head_mask.png", "b": "bioskin_capture1_mask.jpg"}.get(
            path.name[0], ""
        )
        for used in (None, mask) if mask != ALBEDO else (None,):
            (found,) = CheckJob((CaptureFiles(path, used),)).run()
            kinds = {
                wanted: ", ".join(one.kind for one in found.findings if one.level == wanted)
                for wanted in ("finding", "note")
            }
            how = "with its mask" if used else "whole"
            rows.append(f"| `{path.name}` | {how} | {kinds['finding']} | {kinds['note']} |")
    return rows


if __name__ == "__main__":
    main()
