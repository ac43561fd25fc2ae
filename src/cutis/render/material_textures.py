"""The textures of a skin material, written band by band: memory does not grow with the image.

NAME.albedo.exr holds diffuse albedo, half: 11 bits are finer than any capture. Single-scattering
albedo is float: of skin it lies close to 1, where half has steps of 0.0005, while the albedo
depends on its distance from 1. A mean free path that is the same everywhere is three numbers of the
material and no texture.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import LINEAR
from cutis.errors import CutisError
from cutis.maps import Edit, SkinMaps
from cutis.render.inversion import single_scattering_albedo
from cutis.render.material import Triple
from cutis.render.skin import Rows, Skin
from cutis.textures import channel_writer

RGB = ("R", "G", "B")
Radius = Triple | Callable[[SkinMaps], NDArray[np.floating]]
"""Mean free path in mm of red, green, blue: everywhere the same, or (h, W, 3) of maps of (h, W)."""
Progress = Callable[[int, int, str], None]
"""Told (texels done, texels in all, what is done)."""
Writer = Callable[[dict[str, NDArray[np.generic]]], None]


@dataclass(frozen=True)
class Textures:
    """File names, and the mean free path in mm: the same for all texels, or the mean inside."""

    albedo: str
    single_scattering: str
    radius_texture: str | None
    radius: Triple


def write_textures(
    skin: Skin,
    folder: Path,
    name: str,
    radius: Radius,
    anisotropy: float,
    edits: Sequence[Edit] = (),
    amount: float = 1.0,
    progress: Progress | None = None,
) -> Textures:
    """Writes NAME.albedo.exr, NAME.single_scattering.exr and, if `radius` varies, NAME.radius.exr.

    `anisotropy` is the g of the medium that single-scattering albedo and radius are for; its
    boundary is index-matched, as that of the albedo is. All files appear when all are written, or
    none. Raises CutisError for a varying radius of a texture without maps, radii that are not
    positive, and files that cannot be read or written.
    """
    if skin.maps is None and callable(radius):
        raise CutisError(
            f"{skin.path.name} is a texture; a mean free path that follows the skin needs its maps "
            "(NAME.skin.exr), which cutis estimate makes"
        )
    mean = _mean(skin, radius, edits, amount) if callable(radius) else radius
    total = skin.shape[0] * skin.shape[1]
    with contextlib.ExitStack() as stack:
        writers = [
            stack.enter_context(_texture(folder / f"{name}.{kind}.exr", skin.shape, *settings))
            for kind, *settings in KINDS[: 3 if callable(radius) else 2]
        ]
        for rows in skin.bands():
            part = skin.rows(rows, edits, amount)
            writers[0](_channels(part.albedo))
            writers[1](_channels(single_scattering_albedo(part.albedo, anisotropy)))
            if callable(radius):
                writers[2](_channels(_lengths(part, radius, mean)))
            if progress is not None:
                progress(min(rows.stop, skin.shape[0]) * skin.shape[1], total, "writing textures")
    files = [f"{name}.{kind}.exr" for kind, *_ in KINDS]
    return Textures(files[0], files[1], files[2] if callable(radius) else None, mean)


KINDS = (
    ("albedo", "half", "diffuse albedo, linear Rec.709", "lin_rec709_scene"),
    ("single_scattering", "float", "single-scattering albedo of each RGB band", "data"),
    ("radius", "half", "mean free path of each RGB band [mm]", "data"),
)
"""Of each texture: its name, stored type, meaning, and colour space as OpenEXR names it."""


@contextlib.contextmanager
def _texture(
    path: Path, shape: tuple[int, int], dtype: str, meaning: str, space: str
) -> Iterator[Writer]:
    header: dict[str, str | tuple[float, ...]] = {
        "cutis:meaning": meaning,
        "colorInteropID": space,
    }
    if space != "data":
        header["chromaticities"] = LINEAR.chromaticities
    kind = "half" if dtype == "half" else "float"
    with channel_writer(path, RGB, shape, kind, header) as write:  # type: ignore[arg-type]
        yield write


def _channels(rows: NDArray[np.generic]) -> dict[str, NDArray[np.generic]]:
    return {name: rows[..., column] for column, name in enumerate(RGB)}


def _mean(
    skin: Skin,
    radius: Callable[[SkinMaps], NDArray[np.floating]],
    edits: Sequence[Edit],
    amount: float,
) -> Triple:
    """The mean of radii where there is skin; CutisError where they are not positive."""
    sums, count = np.zeros(3), 0
    for rows in skin.bands():
        maps = skin.rows(rows, edits, amount).maps
        assert maps is not None
        lengths = radius(maps)[maps.mask > 0]
        if not (np.isfinite(lengths).all() and (lengths > 0).all()):
            raise CutisError("a mean free path is not positive; check the tissue")
        sums += lengths.sum(axis=0, dtype=np.float64)
        count += len(lengths)
    if not count:
        assert skin.maps is not None
        raise skin.maps.no_mask()
    red, green, blue = sums / count
    return float(red), float(green), float(blue)


def _lengths(
    part: Rows, radius: Callable[[SkinMaps], NDArray[np.floating]], mean: Triple
) -> NDArray[np.floating]:
    """Radii (h, W, 3) of some rows, the mean where there is no skin."""
    assert part.maps is not None
    return np.where((part.maps.mask > 0)[..., None], radius(part.maps), np.asarray(mean))
