"""Rendered light to files that people look at: still pictures and a moving preview."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from cutis.colour import LINEAR, SRGB, Space
from cutis.errors import CutisError
from cutis.textures import Texture, read_texture, replacing, write_texture

EIGHT_BIT = (".png", ".jpg", ".jpeg")
"""Extensions of pictures for the screen; the others hold light: linear, above 1 where it shines."""
SECONDS = 0.08
"""How long the moving preview shows a picture."""


def write_picture(
    light: NDArray[np.floating], path: str | os.PathLike[str], notes: Mapping[str, str]
) -> None:
    """Writes linear Rec.709 light (H, W, 3) as a picture: 8 bit sRGB, or float where it is linear.

    Screen formats clip at 1: nothing is graded, so colours are those of the skin. `notes` become
    metadata. Raises CutisError as `write_texture` does.
    """
    colour = np.ascontiguousarray(light, dtype=np.float32)
    spec = oiio.ImageSpec()
    for name, text in notes.items():
        spec.attribute(name, text)
    if Path(path).suffix.lower() in EIGHT_BIT:
        blank = Texture(np.zeros(colour.shape, np.uint8), ("R", "G", "B"), SRGB, spec=spec)
        picture = blank.with_linear(colour, np.ones(colour.shape[:2], bool))
    else:
        picture = Texture(colour, ("R", "G", "B"), LINEAR, spec=spec)
    write_texture(picture, path)


def write_animation(
    pictures: Sequence[Path], path: Path, space: str | Space = "auto", longest: int = 0
) -> None:
    """Writes a looping WebP of pictures in files; CutisError without any.

    `space` is that of their colours. Where `longest` is given, they are shown in so many pixels of
    the longer side at most: means of squares of theirs.
    """
    from PIL import Image

    if not pictures:
        raise CutisError("a moving preview needs pictures")

    def shown(file: Path) -> Image.Image:
        light = read_texture(file, space).linear()
        blank = Texture(np.zeros(light.shape, np.uint8), ("R", "G", "B"), SRGB)
        picture = blank.with_linear(light, np.ones(light.shape[:2], bool)).pixels
        step = max(1, -(-max(light.shape[:2]) // longest)) if longest else 1
        return Image.fromarray(picture).reduce(step)

    first, *others = (shown(file) for file in pictures)
    with replacing(path) as partial:
        first.save(
            partial, format="WEBP", save_all=True, append_images=others,
            duration=round(1000 * SECONDS), loop=0, quality=90, method=4,
        )  # fmt: skip
