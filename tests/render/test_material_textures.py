"""Textures of a material: what they hold, what they are read as, and that memory stays."""

import tracemalloc

import numpy as np
import pytest

from cutis.colour import LINEAR
from cutis.errors import CutisError
from cutis.maps import Edit, estimate, save_maps
from cutis.maps.changes import Step
from cutis.render import cycles
from cutis.render.inversion import diffuse_albedo
from cutis.render.material_textures import write_textures
from cutis.render.skin import Skin
from cutis.textures import Texture, read_channels, read_texture, write_channels, write_texture

G = 0.78
RADIUS = (0.08, 0.06, 0.05)


@pytest.fixture
def maps(tmp_path, write_face, face_mask):
    path = write_face(tmp_path, "exr")
    skin = estimate(read_texture(path), face_mask)
    save_maps(skin, tmp_path / "face.skin.exr")
    return tmp_path / "face.skin.exr"


def stacked(path):
    channels, metadata = read_channels(path)
    return np.stack([channels[name] for name in "RGB"], axis=-1), metadata


def shown(path, edits=()):
    with Skin(path) as skin:
        return np.concatenate([skin.rows(rows, edits).albedo for rows in skin.bands()])


def write(path, folder, radius=RADIUS, **more):
    with Skin(path) as skin:
        return write_textures(skin, folder, "out", radius, G, **more)


def test_albedo_is_that_of_pictures_and_tells_its_colour_space(maps, tmp_path):
    found = write(maps, tmp_path)
    assert found.files["albedo"] == "out.albedo.exr"
    texture = read_texture(tmp_path / found.files["albedo"])
    assert texture.space == LINEAR
    assert texture.origin != "assumed, the file says nothing"
    np.testing.assert_allclose(texture.linear(), shown(maps), rtol=2**-11, atol=2**-24)


def test_edits_are_in_it(maps, tmp_path):
    edits = [Step((Edit("melanin", "multiply", 3.0),))]
    write(maps, tmp_path, changes=edits)
    edited, _ = stacked(tmp_path / "out.albedo.exr")
    np.testing.assert_allclose(edited, shown(maps, edits), rtol=2**-11, atol=2**-24)
    assert edited.mean() < 0.95 * shown(maps).mean()


def test_single_scattering_gives_the_albedo_back(maps, tmp_path):
    """By the solver forwards: of the medium that the texture describes."""
    found = write(maps, tmp_path)
    stored, metadata = stacked(tmp_path / found.files["single_scattering"])
    assert metadata["colorInteropID"] == "data"
    np.testing.assert_allclose(diffuse_albedo(stored, G), shown(maps), rtol=1e-5)


def test_half_would_be_too_coarse_for_single_scattering(maps, tmp_path):
    """Why it is float: light skin in steps of half is off by more than a code of 8 bits."""
    write(maps, tmp_path)
    stored, _ = stacked(tmp_path / "out.single_scattering.exr")
    exact = diffuse_albedo(stored.astype(np.float64), G)
    coarse = diffuse_albedo(stored.astype(np.float16).astype(np.float64), G)
    finer = diffuse_albedo(stored.astype(np.float32).astype(np.float64), G)
    assert np.abs(coarse / exact - 1).max() > 0.005
    assert np.abs(finer / exact - 1).max() < 1e-5


def test_same_radius_everywhere_is_no_texture(maps, tmp_path):
    found = write(maps, tmp_path)
    assert "radius" not in found.files
    assert found.radius == RADIUS
    assert not list(tmp_path.glob("*.radius.exr"))


def test_radius_follows_the_maps_and_is_the_mean_off_them(maps, tmp_path):
    def radius(skin):
        return np.stack([0.05 + skin.blood, 0.04 + skin.melanin, 0.03 + 0 * skin.blood], axis=-1)

    found = write(maps, tmp_path, radius=radius)
    assert found.files["radius"] == "out.radius.exr"
    stored, metadata = stacked(tmp_path / found.files["radius"])
    assert metadata["cutis:meaning"].endswith("[mm]")
    with Skin(maps) as skin:
        estimated = skin.rows(slice(None)).maps
    inside = estimated.mask > 0
    expected = radius(estimated)
    np.testing.assert_allclose(stored[inside], expected[inside], rtol=2**-11)
    assert found.radius == pytest.approx(expected[inside].mean(axis=0), rel=1e-6)
    assert (~inside).any()
    np.testing.assert_allclose(stored[~inside] - found.radius, 0, atol=1e-4)


def test_radius_that_is_not_positive_leaves_nothing(maps, tmp_path):
    before = sorted(tmp_path.iterdir())
    with pytest.raises(CutisError, match="not positive"):
        write(maps, tmp_path, radius=lambda skin: np.zeros((*skin.shape, 3)))
    assert sorted(tmp_path.iterdir()) == before


def test_texture_has_no_maps_for_a_radius(tmp_path, write_face):
    path = write_face(tmp_path, "png8")
    with pytest.raises(CutisError, match=r"face\.png is a texture; .* cutis estimate makes"):
        write(path, tmp_path, radius=lambda skin: np.ones((*skin.shape, 3)))
    assert write(path, tmp_path).files["albedo"] == "out.albedo.exr"  # else it does


def test_a_write_that_fails_leaves_nothing(maps, tmp_path):
    def stop(done, total, what):
        raise KeyboardInterrupt

    before = sorted(tmp_path.iterdir())
    with pytest.raises(KeyboardInterrupt):
        write(maps, tmp_path, progress=stop)
    assert sorted(tmp_path.iterdir()) == before


def test_progress_reaches_the_end(maps, tmp_path):
    told = []
    write(maps, tmp_path, progress=lambda *event: told.append(event))
    assert told[-1][:2] == (24 * 32, 24 * 32)


def test_cycles_gets_what_its_walk_needs(maps, tmp_path):
    """Its base colour for the albedo, and for that the radius of an isotropic walk."""
    found = write(maps, tmp_path, for_cycles=True)
    colour, _ = stacked(tmp_path / found.files["cycles_colour"])
    radius, _ = stacked(tmp_path / found.files["cycles_radius"])
    wanted = cycles.base_colour(shown(maps), G)
    np.testing.assert_allclose(colour, wanted, rtol=2**-11, atol=2**-24)
    isotropic = np.asarray(RADIUS) / (1 - G)
    np.testing.assert_allclose(radius, cycles.radius(wanted, isotropic), rtol=2**-11)


def test_anisotropy_beyond_cycles_is_one_clear_line(maps, tmp_path):
    with Skin(maps) as skin, pytest.raises(CutisError, match=r"anisotropy = -0\.5"):
        write_textures(skin, tmp_path, "out", RADIUS, -0.5, for_cycles=True)
    assert not list(tmp_path.glob("out.*"))


@pytest.mark.slow
def test_memory_does_not_grow_with_the_image(tmp_path):
    """Four times the rows take no more memory; a whole image of this size would be 50 MB."""
    write_channels(tmp_path / "small.exr", dict.fromkeys("RGB", np.ones((1, 1), np.float32)))
    write(tmp_path / "small.exr", tmp_path, for_cycles=True)  # makes tables
    peaks = []
    for height in (1024, 4096):
        path = tmp_path / f"{height}.exr"
        write_channels(path, dict.fromkeys("RGB", np.full((height, 1024), 0.4, np.float32)))
        tracemalloc.start()
        write(path, tmp_path, for_cycles=True)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.1 * peaks[0]


def test_texels_outside_0_to_1_are_clipped(tmp_path):
    path = tmp_path / "odd.exr"
    colours = np.array([[[-0.1, 0.5, 1.5], [0.2, 0.3, 0.0]]], np.float32)
    write_texture(Texture(colours, ("R", "G", "B"), LINEAR), path)
    write(path, tmp_path)
    for name in ("albedo", "single_scattering"):
        stored, _ = stacked(tmp_path / f"out.{name}.exr")
        assert np.isfinite(stored).all()
        assert stored.min() >= 0
        assert stored.max() <= 1
