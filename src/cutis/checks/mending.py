"""What can be put right, written under a new name: the original is never touched."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from cutis.checks.finding import Finding
from cutis.colour import LINEAR, SRGB, Space
from cutis.textures import Orientation, Texture, read_mask, read_texture, write_texture
from cutis.textures.writing import FORMATS

MENDED = ".fixed"
"""Before the extension of names of mended copies."""


def mended_name(path: Path) -> Path:
    """NAME.fixed.EXT; PNG where nothing is written in that format."""
    end = path.suffix if path.suffix.lower() in FORMATS else ".png"
    return path.with_name(f"{path.stem}{MENDED}{end}")


def mend(
    face: Path,
    mask: Path | None,
    findings: Sequence[Finding],
    space: Space | None = None,
    orientation: Orientation = "auto",
) -> tuple[Path, ...]:
    """Writes NAME.fixed.EXT of a texture and of its mask, where their findings can be mended.

    A turned picture is stored upright, codes become shares of light, a wrong colour space is
    replaced by the other, exposure and cast by the gains that were found, an inverted mask by its
    inverse. Returns the files that were written.
    """
    kinds = {one.kind: one for one in findings}
    written = []
    texture = read_texture(face, space or "auto", None, orientation)
    mended = _mended(texture, kinds)
    if mended is not None:
        target = mended_name(face)
        linear = target.suffix.lower() == ".exr"
        write_texture(mended, target, None if mended.space == texture.space else (
            LINEAR if linear else SRGB))  # fmt: skip
        written.append(target)
    if "mask-inverted" in kinds and mask is not None:
        values = 1 - read_mask(mask, texture.frame, orientation)
        grey = np.rint(255 * np.repeat(values[..., None], 3, axis=-1)).astype(np.uint8)
        target = mended_name(mask)
        write_texture(Texture(grey, ("R", "G", "B"), SRGB), target)
        written.append(target)
    return tuple(written)


def _mended(texture: Texture, kinds: dict[str, Finding]) -> Texture | None:
    """The texture put right; None where nothing can be."""
    found = texture
    if "orientation" in kinds and texture.turned != 1 and texture.spec is not None:
        spec = oiio.ImageSpec(texture.spec)
        spec.attribute("Orientation", 1)
        found = replace(found, spec=spec, turned=1)
    if "scale" in kinds:
        top = next(
            t for t in (255, 1023, 4095, 65535, np.inf) if kinds["scale"].numbers["p95"] <= t
        )
        if np.isfinite(top):
            pixels = (found.pixels.astype(np.float32) / np.float32(top)).astype(found.pixels.dtype)
            found = replace(found, pixels=pixels, space=SRGB)
    if "colour-space" in kinds:
        found = replace(found, space=LINEAR if texture.space.encoded else SRGB)
    gains = np.ones(3)
    if "exposure" in kinds:
        gains = gains * kinds["exposure"].numbers["gain"]
    if "cast" in kinds:
        numbers = kinds["cast"].numbers
        balance = np.array([numbers["red"], numbers["green"], numbers["blue"]])
        gains = gains * (balance / np.prod(balance) ** (1 / 3))
    if (gains != 1).any():
        everywhere = np.ones(found.shape, bool)
        found = found.with_linear(found.linear() * gains.astype(np.float32), everywhere)
    return None if found is texture else found
