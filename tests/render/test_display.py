import numpy as np
import pytest
from PIL import Image

from cutis.colour import encode_srgb
from cutis.errors import CutisError
from cutis.render.display import write_animation, write_picture
from cutis.textures import read_texture

LIGHT = np.random.default_rng(5).uniform(0, 1.3, (9, 7, 3)).astype(np.float32)


def test_screen_pictures_are_8_bit_srgb_and_clip(tmp_path):
    path = tmp_path / "a.png"
    write_picture(LIGHT, path, {"Copyright": "Lee, CC BY"})
    stored = read_texture(path)
    assert stored.pixels.dtype == np.uint8
    expected = np.rint(255 * encode_srgb(np.clip(LIGHT.astype(float), 0, 1)))
    assert np.abs(stored.pixels - expected).max() <= 1
    assert stored.spec.getattribute("Copyright") == "Lee, CC BY"


def test_linear_pictures_keep_all_light(tmp_path):
    path = tmp_path / "a.exr"
    write_picture(LIGHT, path, {})
    np.testing.assert_array_equal(read_texture(path).linear(), LIGHT)


def test_an_animation_shows_every_picture(tmp_path):
    files = []
    for number, grey in enumerate((0.1, 0.4, 0.8)):
        files.append(tmp_path / f"a.{number}.png")
        write_picture(np.full((16, 16, 3), grey), files[-1], {})
    write_animation(files, tmp_path / "a.webp")
    with Image.open(tmp_path / "a.webp") as film:
        assert film.n_frames == 3
        means = []
        for number in range(3):
            film.seek(number)
            means.append(np.asarray(film.convert("RGB")).mean())
    np.testing.assert_allclose(means, [255 * encode_srgb(v) for v in (0.1, 0.4, 0.8)], atol=2)


def test_an_animation_of_nothing_is_refused(tmp_path):
    with pytest.raises(CutisError):
        write_animation([], tmp_path / "a.webp")
