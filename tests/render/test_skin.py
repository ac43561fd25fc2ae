import numpy as np
import pytest

from cutis.colour import LINEAR
from cutis.errors import CutisError
from cutis.inverse import Calibration
from cutis.maps import Edit, estimate, save_maps
from cutis.maps.changes import Step
from cutis.render.skin import Skin
from cutis.textures import Texture, read_texture, write_texture

SHAPE = (12, 10)
RNG = np.random.default_rng(3)
COLOURS = (np.array([0.5, 0.3, 0.22]) * RNG.uniform(0.7, 1.0, (*SHAPE, 1))).astype(np.float32)


@pytest.fixture
def face(tmp_path):
    path = tmp_path / "face.exr"
    write_texture(Texture(COLOURS, ("R", "G", "B"), LINEAR), path)
    return path


@pytest.fixture
def maps(tmp_path, face):
    mask = np.ones(SHAPE, np.float32)
    mask[:, -2:] = 0
    texture = read_texture(face)
    skin = estimate(texture, mask, white=(1.05, 1.0, 0.98))
    path = tmp_path / "face.skin.exr"
    save_maps(skin, path)
    return path


def rows_of(path, edits=(), **options):
    with Skin(path, **options) as skin:
        return np.concatenate([skin.rows(band, edits).albedo for band in skin.bands()])


def test_a_texture_is_taken_as_it_is(face):
    np.testing.assert_array_equal(rows_of(face), COLOURS)


def test_maps_give_the_calibrated_capture(maps):
    gains = Calibration((1.05, 1.0, 0.98)).apply(COLOURS)
    np.testing.assert_allclose(rows_of(maps), gains, atol=1e-6)


def test_edits_are_in_the_albedo_on_skin_only(maps):
    before, after = rows_of(maps), rows_of(maps, [Step((Edit("melanin", "multiply", 3.0),))])
    assert (after[:, :-2] < before[:, :-2]).all()
    np.testing.assert_array_equal(after[:, -2:], before[:, -2:])


def test_the_model_alone_needs_no_capture(maps, face):
    model = rows_of(maps, model_only=True)
    assert np.abs(model - rows_of(maps))[:, :-2].max() < 5e-3
    assert (model[:, -2:] == 0).all()
    face.unlink()
    np.testing.assert_array_equal(rows_of(maps, model_only=True), model)
    with pytest.raises(CutisError, match="missing"):
        rows_of(maps)


def test_edits_of_a_texture_are_refused(face):
    with pytest.raises(CutisError, match="cutis estimate"):
        rows_of(face, [Edit("melanin", "multiply", 3.0)])


def test_colours_are_albedos(tmp_path):
    path = tmp_path / "odd.exr"
    odd = np.stack([COLOURS[..., 0] * 4, COLOURS[..., 1] - 0.4, COLOURS[..., 2]], axis=-1)
    write_texture(Texture(odd, ("R", "G", "B"), LINEAR), path)
    found = rows_of(path)
    np.testing.assert_array_equal(found, np.clip(odd, 0, 1))


def test_names(maps, face):
    for path in (maps, face):
        with Skin(path) as skin:
            assert skin.stem == "face"
            assert skin.shape == SHAPE
