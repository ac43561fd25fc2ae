import numpy as np

from cutis.colour import LINEAR
from cutis.render.feed import write_feed
from cutis.render.skin import Skin
from cutis.textures import Texture, read_texture, write_texture

COLOURS = np.random.default_rng(2).uniform(0.05, 0.9, (37, 22, 3)).astype(np.float32)


def fed(tmp_path, longest):
    write_texture(Texture(COLOURS, ("R", "G", "B"), LINEAR), tmp_path / "a.exr")
    with Skin(tmp_path / "a.exr") as skin:
        write_feed(skin, tmp_path / "b.exr", lambda rows: rows.albedo**2, longest=longest)
    return read_texture(tmp_path / "b.exr").linear()


def test_small_textures_go_texel_by_texel(tmp_path):
    np.testing.assert_allclose(fed(tmp_path, 64), COLOURS**2, rtol=1e-3)


def test_large_ones_become_means(tmp_path):
    found = fed(tmp_path, 10)
    blocks = (COLOURS**2)[:36, :20].reshape(9, 4, 5, 4, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(found, blocks, rtol=1e-3)
