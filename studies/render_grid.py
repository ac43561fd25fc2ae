"""Renders the paper's editing grid: `python -m studies.render_grid`, then docs/renders/ is new.

Six skins, light to dark, as they are and with six edits of blood and melanin, under three lights:
126 pictures. A run that was stopped goes on where it was (pictures are kept in build/renders).
Needs Blender: `make setup-render`.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import get_data_path
from PIL import Image, ImageDraw, ImageFont
from rich.progress import Progress

import cutis
from cutis.colour import lab
from cutis.jobs.render import RenderJob
from cutis.jobs.render import Subject as Shown
from cutis.looks.presets import preset
from cutis.render.frames import Frame
from cutis.render.heads import Head, head
from cutis.render.scene import Scene
from cutis.textures import read_texture
from studies.figures.edits import DARK, LABELS, LIGHT
from studies.generated import record
from studies.pages import rewrite

ROOT = Path(__file__).parents[1]
WORK, PAGE = ROOT / "build" / "renders", ROOT / "docs" / "renders"
LIGHTS = ("studio", "sun", "interior")
CAPTION = 18


@dataclass(frozen=True)
class Subject:
    """A skin on a head, and the edits that suit it."""

    label: str
    head: Head
    albedo: str
    edits: tuple[str, ...]

    @property
    def maps(self) -> Path:
        return WORK / f"{self.albedo}.skin.exr"

    def estimate(self) -> None:
        face = cutis.read(self.head.albedos[self.albedo])
        mask = None if self.head.mask is None else cutis.read_mask(self.head.mask, face.shape)
        cutis.estimate(face, mask, white="auto").save(self.maps)


def subjects() -> list[Subject]:
    scan, made = head("leeperrysmith"), head("makehuman")
    return [
        Subject("very light", scan, "scan", LIGHT),
        Subject("light, young", made, "young_light_female2", LIGHT),
        Subject("light", made, "middleage_light_male", LIGHT),
        Subject("intermediate", made, "old_light_male2", LIGHT),
        Subject("brown", made, "african_middleage_mindfront", DARK),
        Subject("dark", made, "young_dark_male", DARK),
    ]


def sheet(rows: list[list[Path]], labels: list[list[str]]) -> Image.Image:
    """Pictures in rows, each under its label."""
    font = ImageFont.truetype(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), 11)
    side = Image.open(rows[0][0]).width
    page = Image.new("RGB", (side * len(rows[0]), (side + CAPTION) * len(rows)), "white")
    for y, (files, names) in enumerate(zip(rows, labels, strict=True)):
        for x, (file, name) in enumerate(zip(files, names, strict=True)):
            place = (x * side, y * (side + CAPTION))
            ImageDraw.Draw(page).text((place[0] + 4, place[1] + 1), name, "black", font)
            page.paste(Image.open(file), (place[0], place[1] + CAPTION))
    return page


def seen(file: Path) -> np.ndarray:
    """Median L*a*b* of the middle of a picture: forehead, cheeks, nose."""
    light = read_texture(file).linear()
    height, width = light.shape[:2]
    middle = light[height // 3 : 2 * height // 3, width // 3 : 2 * width // 3]
    return np.median(lab(middle.reshape(-1, 3)), axis=0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--samples", type=int, default=48)
    options = parser.parse_args()
    for folder in (WORK, PAGE):
        folder.mkdir(parents=True, exist_ok=True)
    cast = subjects()
    for subject in cast:
        if not subject.maps.is_file():
            subject.estimate()
    table = [
        "| light | skin | blood × 0.125 | × 0.5 | × 3 "
        "| melanin × 1.5 (0.5) | × 3 (1.5) | × 5 (3) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    with Progress() as bar:
        task = bar.add_task("rendering", total=len(LIGHTS) * len(cast))
        for light in LIGHTS:
            rows, labels = [], []
            for subject in cast:
                scene = Scene(
                    mesh=subject.head.mesh, millimetres_per_unit=subject.head.millimetres,
                    light=light, width=options.size, height=options.size, samples=options.samples,
                    zoom=subject.head.zoom, centre=subject.head.centre,
                )  # fmt: skip
                frames = [Frame(1), *(
                    Frame(k, edits=preset(name)) for k, name in enumerate(subject.edits, 2)
                )]  # fmt: skip
                stem = WORK / f"{subject.albedo}-{light}"
                shown = Shown(subject.maps, scene)
                RenderJob(shown, stem.with_suffix(".png"), tuple(frames)).run()
                files = [Path(f"{stem}.{frame.number:04d}.png") for frame in frames]
                names = [LABELS[name] for name in subject.edits]
                rows.append(files)
                labels.append([f"{subject.label}: original", *names])
                plain = seen(files[0])
                changes = [seen(file) - plain for file in files[1:]]
                cells = " | ".join(f"{by[0]:+.1f}, {by[1]:+.1f}" for by in changes)
                table.append(f"| {light} | {subject.label} | {cells} |")
                bar.advance(task)
            sheet(rows, labels).save(PAGE / f"grid-{light}.jpg", quality=88)
            record(PAGE / f"grid-{light}.jpg")
    rewrite("render.md", grid="\n".join(table))


if __name__ == "__main__":
    main()
