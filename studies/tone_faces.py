"""The faces that tones and looks are tried on: reduced, with maps of the default model."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.maps import SkinMaps, estimate
from cutis.textures import read_mask, read_texture
from studies.figures.subjects import data_folder

LONGEST = 480
"""Texels of the longer side, about."""
MADE = "makehuman_head_mask.png"
FACES = {
    "capture": ("bioskin_capture1.jpg", "bioskin_capture1_mask.jpg"),
    "scan": ("leeperrysmith_color.jpg", None),
    "painted, light": ("reom_light_face.jpg", None),
    "painted, dark": ("reom_dark_face.jpg", None),
    **{
        name.replace("_", " "): (f"makehuman_{name}_head.png", MADE)
        for name in (
            "young_light_female2", "young_light_male", "middleage_light_male", "old_light_male2",
            "african_middleage_mindfront", "middleage_dark_male", "young_dark_male",
        )
    },
}  # fmt: skip
"""Files of the larger data and masks; `makehuman_old_dark_female` is painted grey, no skin."""
THREE = ("capture", "old light male2", "painted, dark")
"""A light, a brown and a dark face."""


@dataclass(frozen=True, eq=False)
class Tried:
    """A face, its maps with their capture, and where it is surely skin (H, W)."""

    name: str
    skin: SkinMaps
    sure: NDArray[np.bool_]

    def seen(self, colours: NDArray[np.float32]) -> NDArray[np.float32]:
        """Colours as captured → calibrated."""
        return self.skin.calibration.apply(colours)


def tried(names: tuple[str, ...] = tuple(FACES), model: str | None = None) -> Iterator[Tried]:
    """The faces by name; ends the program where the larger data is absent."""
    data = data_folder(None)
    if data is None:
        raise SystemExit("the larger data is absent; name its folder in CUTIS_SHARED_DATA")
    for name in names:
        picture, mask = FACES[name]
        colours, cover = reduced(data / "albedo" / picture, mask and data / "albedo" / mask)
        how = {} if model is None else {"model": model}
        skin = estimate(colours, cover, white="auto", **how)
        assert skin.confidence is not None
        yield Tried(name, skin, (skin.mask > 0) & (skin.confidence >= 0.5))


def reduced(
    picture: Path, mask: Path | None
) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]:
    """Means over squares of texels, linear sRGB, and the mask in their middle."""
    texture = read_texture(picture)
    colours = texture.linear()
    step = max(1, round(max(colours.shape) / LONGEST))
    high, wide = (side // step * step for side in colours.shape[:2])
    cells = colours[:high, :wide].reshape(high // step, step, wide // step, step, 3)
    cover = None
    if mask is not None:
        whole = read_mask(mask, texture.shape)
        cover = np.ascontiguousarray(whole[step // 2 : high : step, step // 2 : wide : step])
    return np.asarray(cells.mean((1, 3)), np.float32), cover
