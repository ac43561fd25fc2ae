"""OpenColorIO configurations: a small one of our own, and the built-in ones."""

import sys

import numpy as np
import pytest

from cutis.colour import LINEAR, SRGB, rgb_space
from cutis.colour.spaces import ACES2065_1, RGBSpace
from cutis.errors import CutisError
from cutis.textures import Texture
from cutis.textures.ocio import BUILT_IN, OcioSpace, ocio_names, ocio_space

STUDIO = """ocio_profile_version: 2
environment: {}
search_path: ""
roles:
  aces_interchange: interchange
  scene_linear: show_lin
  default: show_lin
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Raw, colorspace: masks}
colorspaces:
  - !<ColorSpace>
    name: interchange
  - !<ColorSpace>
    name: show_lin
    aliases: [work, "Show Größe"]
    to_scene_reference: !<MatrixTransform> {matrix: [0.695452241357, 0.140678696470, 0.163869062172, 0,
      0.044794563372, 0.859671118456, 0.095534318172, 0,
      -0.005525882558, 0.004025210306, 1.001500672252, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: gamma
    to_scene_reference: !<ExponentTransform> {value: [2.2, 2.2, 2.2, 1]}
  - !<ColorSpace>
    name: log
    to_scene_reference: !<LogAffineTransform> {base: 10, log_side_slope: 0.25, log_side_offset: 0.5,
      lin_side_slope: 5, lin_side_offset: 0.05, direction: inverse}
  - !<ColorSpace>
    name: one way
    to_scene_reference: !<FileTransform> {src: gone.cube}
  - !<ColorSpace>
    name: masks
    isdata: true
"""  # noqa: E501
BARE = STUDIO.replace("  aces_interchange: interchange\n", "").replace(
    "name: interchange", "name: reference"
)


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "show.ocio"
    path.write_text(STUDIO, encoding="utf-8")
    return str(path)


@pytest.fixture
def without_opencolorio(monkeypatch):
    ocio_space.cache_clear()
    monkeypatch.setitem(sys.modules, "PyOpenColorIO", None)
    yield
    ocio_space.cache_clear()


def refused(*arguments):
    with pytest.raises(CutisError) as caught:
        ocio_space(*arguments)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def test_names_roles_and_aliases(config):
    for name in ("show_lin", "SHOW_LIN", "scene_linear", "work", "show größe", "default"):
        assert ocio_space(name, config) == rgb_space("ACEScg"), name
    assert ocio_space("aces_interchange", config) == ACES2065_1
    assert ocio_space("nothing", config) is None
    assert ocio_space("scene_linear") == rgb_space("ACEScg")
    assert ocio_space("sRGB - Texture") is SRGB
    assert ocio_space("lin_srgb") is LINEAR


def test_a_log_space(config):
    log = ocio_space("log", config)
    assert (log.name, log.encoded, log.chromaticities) == ("log", True, None)
    stored = np.array([[0.3, 0.4, 0.5]])
    aces = (10 ** ((stored - 0.5) / 0.25) - 0.05) / 5
    np.testing.assert_allclose(
        log.to_linear_srgb(stored), ACES2065_1.to_linear_srgb(aces), rtol=1e-5
    )
    gamma = ocio_space("gamma", config)
    assert gamma.encoded
    assert gamma != log
    assert log == ocio_space("log", config)
    assert hash(log) == hash(ocio_space("log", config))


def test_linear_spaces_say_their_chromaticities():
    wide = ocio_space("lin_awg4")
    assert isinstance(wide, OcioSpace)
    assert not wide.encoded
    expected = (0.7347, 0.2653, 0.1424, 0.8576, 0.0991, -0.0308, 0.3127, 0.3290)
    np.testing.assert_allclose(wide.chromaticities, expected, atol=5e-3)  # theirs adapt by CAT02
    xy = np.reshape(wide.chromaticities, (4, 2))
    same = RGBSpace("by numbers", tuple(map(tuple, xy[:3])), tuple(xy[3]))
    values = np.random.default_rng(0).uniform(0, 1, (50, 3))
    np.testing.assert_allclose(same.to_linear_srgb(values), wide.to_linear_srgb(values), atol=1e-5)


def test_stored_texels_of_every_kind(random):
    """Columns come in whatever order memory has them."""
    for dtype in ("uint8", "uint16", "float16", "float32"):
        scale = np.iinfo(dtype).max if dtype[0] == "u" else 1
        pixels = (random.uniform(0.2, 0.6, (7, 5, 4)) * scale).astype(dtype)
        for names in ("ABGR", "RGBA"):
            space = ocio_space("ARRI LogC4")
            pixels[..., names.index("A")] = scale * 0.7
            one = Texture(pixels, tuple(names), space, associated=dtype[0] == "f")
            linear = one.linear()
            values = pixels[..., [names.index(c) for c in "RGB"]].astype(np.float32) / scale
            if one.associated:
                values = values / one.alpha()[..., None]
            np.testing.assert_allclose(linear, space.to_linear_srgb(values), rtol=1e-5, atol=1e-6)
            again = one.with_linear(linear, np.ones(one.shape, bool)).pixels
            tolerance = 1 if dtype[0] == "u" else 2e-3 if dtype == "float16" else 1e-5
            np.testing.assert_allclose(again, pixels, rtol=0, atol=tolerance)


def test_measured_skins_come_back_from_every_space(measured_rgb):
    names, _ = ocio_names()
    assert len(names) > 50
    for name in names:
        space = ocio_space(name)
        again = space.to_linear_srgb(space.from_linear_srgb(measured_rgb))
        # densities of films are tables of few entries
        tolerance = 1e-2 if name.startswith("ADX") else 1e-5
        error = abs(again - measured_rgb)[measured_rgb.min(axis=1) >= 0]  # two are out of gamut
        assert len(error) > 7000
        assert error.max() < tolerance, name


def test_names_of_a_configuration(config):
    spaces, others = ocio_names(config)
    assert spaces == ["interchange", "show_lin", "gamma", "log", "one way"]
    assert {"work", "scene_linear"} <= set(others)


def test_what_cannot_be_used_is_said_in_one_line(config, tmp_path):
    assert refused("masks", config) == "masks holds data, not colour; name a colour space"
    assert "gone.cube" in refused("one way", config)
    bare = tmp_path / "bare.ocio"
    bare.write_text(BARE, encoding="utf-8")
    assert "aces_interchange" in refused("show_lin", str(bare))
    assert ocio_space("nothing", str(bare)) is None
    broken = tmp_path / "broken.ocio"
    for text in ("", "hello", "ocio_profile_version: 9\n", STUDIO[:900], "\0\1\2" * 50):
        broken.write_text(text, encoding="utf-8")
        from cutis.textures import ocio

        ocio._config.cache_clear()
        ocio_space.cache_clear()
        assert "not a usable OpenColorIO configuration" in refused("log", str(broken)), text
    assert "not a usable" in refused("log", str(tmp_path / "gone.ocio"))
    assert "not a usable" in refused("log", str(tmp_path))
    assert "not a usable" in refused("log", "ocio://no-such")


@pytest.mark.parametrize(
    "name", ["lin_rec709", "Utility - Linear - sRGB", "ACES - ACES2065-1", "lin_srgb"]
)
def test_configurations_from_before_the_role(tmp_path, name):
    path = tmp_path / "old.ocio"
    text = BARE.replace("name: reference", f"name: {name}")
    path.write_text(text, encoding="utf-8")
    here = ACES2065_1 if "ACES" in name else LINEAR
    gamma = ocio_space("gamma", str(path))
    np.testing.assert_allclose(
        gamma.to_linear_srgb([0.1, 0.5, 0.7]),
        here.to_linear_srgb(np.array([0.1, 0.5, 0.7]) ** 2.2), rtol=1e-5,
    )  # fmt: skip


def test_without_opencolorio(without_opencolorio, config):
    assert ocio_space("ACEScg") is None
    assert "pip install opencolorio" in refused("ACEScg", config)


def test_the_built_in_configuration_is_named_in_full():
    import PyOpenColorIO as ocio

    assert BUILT_IN.removeprefix("ocio://") in [
        name for name, *_ in ocio.BuiltinConfigRegistry().getBuiltinConfigs()
    ]
