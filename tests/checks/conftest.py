"""Bundled heads, small, as arrays, and what the checks find in them once they are in a file."""

from importlib import resources

import numpy as np
import pytest

from cutis.checks import examine, gather
from cutis.colour import SRGB
from cutis.maps import FileCapture
from cutis.textures import MaskFile, Texture, TextureFile, read_mask, read_texture, write_texture

HEADS = {
    "light": ("leeperrysmith_color.jpg", False),
    "brown": ("makehuman_old_light_male2.jpg", True),
    "dark": ("makehuman_young_dark_male.jpg", True),
}


@pytest.fixture(scope="session")
def heads():
    """Linear sRGB (H, W, 3) and mask (H, W) of a light, a brown and a dark head."""
    found = {}
    for tone, (name, masked) in HEADS.items():
        with resources.as_file(resources.files("cutis.data") / "heads") as folder:
            texture = read_texture(folder / name)
            mask = np.ones(texture.shape, np.float32)
            if masked:
                mask = read_mask(folder / "makehuman_head_mask.png", texture.frame)
            found[tone] = texture.linear(), mask
    return found


@pytest.fixture
def look(tmp_path):
    """`look(rgb, mask, end, dtype, space)` writes a texture and gives what is found in it."""

    def found(rgb, mask=None, end=".png", dtype=np.uint8, space=SRGB, limits=None):
        blank = np.zeros(rgb.shape, dtype)
        whole = Texture(blank, ("R", "G", "B"), space)
        everywhere = np.ones(rgb.shape[:2], bool)
        path = tmp_path / f"face{end}"
        write_texture(whole.with_linear(rgb, everywhere), path, space)
        return at(path, mask, limits)

    def at(path, mask=None, limits=None):
        with TextureFile(path) as texture:
            if mask is None:
                return examine(gather(FileCapture(texture)), limits=limits)
            grey = np.uint8(np.rint(255 * np.repeat(mask[..., None], 3, axis=-1)))
            write_texture(Texture(grey, ("R", "G", "B"), SRGB), tmp_path / "mask.png")
            with MaskFile(tmp_path / "mask.png", texture.frame) as opened:
                return examine(gather(FileCapture(texture, opened)), limits=limits)

    found.at = at
    return found


def kinds(examined, level="finding"):
    """Kinds of the findings of a level."""
    return {one.kind for one in examined.findings if one.level == level}
