"""The faces that figures are drawn with: the bundled capture and those of the larger data."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import is_skin_colour
from cutis.errors import CutisError
from cutis.inverse.shipped import EXACT
from cutis.maps import SkinMaps, estimate
from cutis.textures import read_mask, read_texture

TALLEST = 420
"""Rows of a face in a figure."""
CHOSEN = (
    # file, mask, top and bottom, left and right of the crop, who, credit
    ("leeperrysmith_color.jpg", None, (0.08, 0.92), (0.12, 0.88), "very light",
     "Lee Perry-Smith, CC BY 3.0"),
    ("makehuman_middleage_light_male_head.png", "makehuman_head_mask.png", (0.0, 1.0), (0.2, 0.8),
     "light", "MakeHuman team, CC0"),
    ("bioskin_capture1.jpg", "bioskin_capture1_mask.jpg", (0.22, 0.86), (0.12, 0.88),
     "intermediate", "© Meta Platforms, MIT, from BioSkin"),
    ("makehuman_african_middleage_mindfront_head.png", "makehuman_head_mask.png", (0.0, 1.0),
     (0.2, 0.8), "brown", "MINDFRONT for MakeHuman, CC0"),
    ("reom_dark_face.jpg", None, (0.1, 0.9), (0.1, 0.9), "dark", "ComplexAce and Hope, CC BY"),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Subject:
    """A face: `rgb` (H, W, 3) linear sRGB as captured, `mask` (H, W), reduced for figures."""

    name: str
    skin: str
    credit: str
    rgb: NDArray[np.float32]
    mask: NDArray[np.float32]

    @cached_property
    def maps(self) -> SkinMaps:
        """Skin maps by the exact model of the paper's tissue, white balance found automatically."""
        return estimate(self.rgb, self.mask, white="auto", model=EXACT)

    def maps_by(self, model: str) -> SkinMaps:
        """Skin maps by another model under the same calibration."""
        gains = self.maps.calibration.gains
        return estimate(self.rgb, self.mask, white=gains, model=model)

    @cached_property
    def calibrated(self) -> NDArray[np.float32]:
        """(H, W, 3) what models are asked to reproduce."""
        return self.maps.calibration.apply(self.rgb)

    @cached_property
    def texels(self) -> NDArray[np.bool_]:
        """(H, W) where numbers are taken: inside the mask, not hair, eyes or background."""
        return _skin_texels(self.calibrated, self.mask)


def data_folder(given: Path | None) -> Path | None:
    """The folder of the larger data: `given`, $CUTIS_SHARED_DATA, or shared/data by the clone."""
    if given is not None:
        if not (given / "albedo").is_dir():
            raise CutisError(f"{given}: no folder albedo in it; name the folder of the larger data")
        return given
    clone = Path(__file__).parents[2]
    usual = Path(os.environ.get("CUTIS_SHARED_DATA") or clone.parent / "shared" / "data")
    return usual if (usual / "albedo").is_dir() else None


@dataclass(frozen=True, eq=False)
class Cast:
    """What figures are drawn from: the larger data, if it is at hand, and the faces."""

    data: Path | None
    subjects: tuple[Subject, ...]

    @cached_property
    def credits(self) -> tuple[str, ...]:
        """Who made the textures."""
        return tuple(f"{s.name}: {s.credit}" for s in self.subjects)


def cast(given: Path | None = None) -> Cast:
    """The faces at hand; see `data_folder`."""
    data = data_folder(given)
    return Cast(data, tuple(subjects(data)))


def subjects(data: Path | None) -> list[Subject]:
    """The chosen faces, light to dark; the bundled capture alone without the larger data."""
    examples = Path(__file__).parents[2] / "examples"
    found = []
    for file, mask, rows, columns, skin, credit in CHOSEN:
        folders = [examples] + ([data / "albedo"] if data else [])
        folder = next((f for f in folders if (f / file).is_file()), None)
        if folder is not None:
            cover = None if mask is None else folder / mask
            found.append(_subject(folder / file, cover, rows, columns, skin, credit))
    if not found:
        raise CutisError("figures need a clone of the repository, or --data with face albedos")
    return found


def every_face(data: Path | None, most: int) -> Iterator[tuple[str, NDArray[np.float32]]]:
    """Name and at most `most` skin colours (n, 3) of every face at hand, as captured."""
    examples = Path(__file__).parents[2] / "examples"
    paths = {path.name: path for path in sorted(examples.glob("*.jpg"))}
    if data is not None:
        paths |= {path.name: path for path in sorted((data / "albedo").glob("*.*g"))}
    for name, path in sorted(paths.items()):
        if "mask" in name:
            continue
        texture = read_texture(path)
        cover = path.with_name(f"{path.stem}_mask{path.suffix}")
        if name.startswith("makehuman"):
            cover = path.with_name("makehuman_head_mask.png")
        rgb = texture.linear()
        mask = np.ones(texture.shape, np.float32)
        if cover.is_file():
            mask = read_mask(cover, texture.shape)
        step = max(1, int(np.sqrt(rgb.shape[0] * rgb.shape[1] / most)) // 2)
        where = _skin_texels(rgb[::step, ::step], mask[::step, ::step])
        colours = rgb[::step, ::step][where]
        yield path.stem, np.ascontiguousarray(colours[:: -(-len(colours) // most)])


def _skin_texels(rgb: NDArray[np.float32], mask: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(H, W) texels inside the mask that are neither hair, eyes nor background."""
    inside = mask > 0.5
    coloured = inside & is_skin_colour(rgb)
    if coloured.mean() > 0.2 * inside.mean():
        return coloured
    luminance = rgb @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
    return inside & (luminance > 0.5 * np.median(luminance[inside]))


def _subject(
    path: Path, mask: Path | None, rows: tuple[float, float], columns: tuple[float, float],
    skin: str, credit: str,
) -> Subject:  # fmt: skip
    texture = read_texture(path)
    height, width = texture.shape
    cover = np.ones(texture.shape, np.float32) if mask is None else read_mask(mask, texture.shape)
    crop = (
        slice(int(rows[0] * height), int(rows[1] * height)),
        slice(int(columns[0] * width), int(columns[1] * width)),
    )
    step = max(1, -(-(crop[0].stop - crop[0].start) // TALLEST))
    reduced = _reduced(np.dstack([texture.linear(), cover])[crop], step)
    covered = (reduced[..., 3] > 0.99).astype(np.float32)
    return Subject(path.stem, skin, credit, np.ascontiguousarray(reduced[..., :3]), covered)


def _reduced(values: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """Means over squares of `step` texels."""
    height, width = (n // step * step for n in values.shape[:2])
    blocks = values[:height, :width].reshape(height // step, step, width // step, step, -1)
    return np.asarray(blocks.mean(axis=(1, 3)), dtype=np.float32)
