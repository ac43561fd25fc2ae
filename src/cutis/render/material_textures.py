"""The textures of a skin material, written band by band: memory does not grow with the image.

NAME.albedo.exr holds diffuse albedo, half: 11 bits are finer than any capture. Single-scattering
albedo is float: of skin it lies close to 1, where half has steps of 0.0005, while the albedo
depends on its distance from 1. A mean free path that is the same everywhere is three numbers of the
material and no texture.
"""

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutis.colour import LINEAR
from cutis.errors import CutisError
from cutis.maps import Change, SkinMaps
from cutis.render import cycles
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
    """File names by kind (see `KINDS`); mean free path in mm: the same everywhere, or the mean."""

    files: Mapping[str, str]
    radius: Triple


def write_textures(
    skin: Skin,
    folder: Path,
    name: str,
    radius: Radius,
    anisotropy: float,
    changes: Sequence[Change] = (),
    for_cycles: bool = False,
    progress: Progress | None = None,
) -> Textures:
    """Writes NAME.albedo.exr, NAME.single_scattering.exr and, if `radius` varies, NAME.radius.exr.

    `anisotropy` is the g of the medium that single-scattering albedo and radius are for; its
    boundary is index-matched, as that of the albedo is. `for_cycles` adds NAME.cycles_colour.exr
    and NAME.cycles_radius.exr, with which Cycles returns the albedo (`render.cycles`). All files
    appear when all are written, or none. Raises CutisError for a varying radius of a texture
    without maps, radii that are not positive, anisotropies out of range, and files that cannot be
    read or written.
    """
    if skin.maps is None and callable(radius):
        raise CutisError(
            f"{skin.path.name} is a texture; a mean free path that follows the skin needs its maps "
            "(NAME.skin.exr), which cutis estimate makes"
        )
    mean = _mean(skin, radius, changes) if callable(radius) else radius
    makers = _makers(radius, mean, anisotropy, for_cycles)
    total = skin.shape[0] * skin.shape[1]
    with contextlib.ExitStack() as stack:
        writers = {
            kind: stack.enter_context(
                _texture(folder / f"{name}.{kind}.exr", skin.shape, *KINDS[kind])
            )
            for kind in makers
        }
        for rows in skin.bands():
            part = skin.rows(rows, changes)
            for kind, make in makers.items():
                writers[kind](_channels(make(part)))
            if progress is not None:
                progress(min(rows.stop, skin.shape[0]) * skin.shape[1], total, "writing textures")
    return Textures({kind: f"{name}.{kind}.exr" for kind in makers}, mean)


KINDS = {
    "albedo": ("half", "diffuse albedo, linear Rec.709", "lin_rec709_scene"),
    "single_scattering": ("float", "single-scattering albedo of each RGB band", "data"),
    "radius": ("half", "mean free path of each RGB band [mm]", "data"),
    "cycles_colour": (
        "half",
        "base colour with which Cycles returns the albedo",
        "lin_rec709_scene",
    ),
    "cycles_radius": ("half", "subsurface radius for that base colour [mm]", "data"),
}
"""Of each texture: stored type, meaning, and colour space as OpenEXR names it."""


def _makers(
    radius: Radius, mean: Triple, anisotropy: float, for_cycles: bool
) -> dict[str, Callable[[Rows], NDArray[np.generic]]]:
    """What makes each kind of texture from some rows of the skin."""

    def lengths(part: Rows) -> NDArray[np.floating]:
        return _lengths(part, radius, mean) if callable(radius) else np.asarray(mean)

    def for_walk(part: Rows) -> NDArray[np.floating]:
        colour = cycles.base_colour(part.albedo, anisotropy)
        return cycles.radius(colour, lengths(part) / (1 - anisotropy))

    makers: dict[str, Callable[[Rows], NDArray[np.generic]]] = {
        "albedo": lambda part: part.albedo,
        "single_scattering": lambda part: single_scattering_albedo(part.albedo, anisotropy),
    }
    if callable(radius):
        makers["radius"] = lengths
    if for_cycles:
        cycles.check_anisotropy(anisotropy)
        makers["cycles_colour"] = lambda part: cycles.base_colour(part.albedo, anisotropy)
        makers["cycles_radius"] = for_walk
    return makers


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
    changes: Sequence[Change],
) -> Triple:
    """The mean of radii where there is skin; CutisError where they are not positive."""
    sums, count = np.zeros(3), 0
    for rows in skin.bands():
        maps = skin.rows(rows, changes).maps
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
