"""The faces that figures are drawn with: the bundled capture and those of the larger data."""

import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import is_skin_colour
from cutis.errors import CutisError
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
        """Skin maps by the default model, white balance found automatically."""
        return estimate(self.rgb, self.mask, white="auto")

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
        inside = self.mask > 0.5
        if not (inside & is_skin_colour(self.calibrated)).mean() > 0.2 * inside.mean():
            luminance = self.calibrated @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
            return inside & (luminance > 0.5 * np.median(luminance[inside]))
        return inside & is_skin_colour(self.calibrated)


def data_folder(given: Path | None) -> Path | None:
    """The folder of the larger data: `given`, $CUTIS_SHARED_DATA, or shared/data by the clone."""
    if given is not None:
        if not (given / "albedo").is_dir():
            raise CutisError(f"{given}: no folder albedo in it; name the folder of the larger data")
        return given
    clone = Path(__file__).parents[3]
    usual = Path(os.environ.get("CUTIS_SHARED_DATA") or clone.parent / "shared" / "data")
    return usual if (usual / "albedo").is_dir() else None


def subjects(data: Path | None) -> list[Subject]:
    """The chosen faces, light to dark; the bundled capture alone without the larger data."""
    examples = Path(__file__).parents[3] / "examples"
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
