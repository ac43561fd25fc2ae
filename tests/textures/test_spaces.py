"""Which space a name means."""

import sys

import numpy as np
import pytest

from cutis.colour import LINEAR, SRGB, rgb_space
from cutis.colour.spaces import RGBSpace
from cutis.errors import CutisError
from cutis.textures import colour_space, ocio
from cutis.textures.spaces import sibling

CONFIG = """ocio_profile_version: 2
roles: {aces_interchange: reference, default: linear}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: Raw, colorspace: linear}
colorspaces:
  - !<ColorSpace> {name: reference}
  - !<ColorSpace>
    name: linear
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
"""
P3 = rgb_space("Display P3")


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "show.ocio"
    path.write_text(CONFIG, encoding="utf-8")
    return str(path)


@pytest.fixture
def bare(monkeypatch):
    """No $OCIO and no OpenColorIO."""
    monkeypatch.delenv("OCIO", raising=False)
    monkeypatch.setitem(sys.modules, "PyOpenColorIO", None)
    for cache in (ocio.ocio_space, ocio._config):
        cache.cache_clear()
    yield
    for cache in (ocio.ocio_space, ocio._config):
        cache.cache_clear()


def unknown(*arguments):
    with pytest.raises(CutisError) as caught:
        colour_space(*arguments)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


def test_a_configuration_comes_first(config, monkeypatch):
    monkeypatch.delenv("OCIO", raising=False)
    assert colour_space("linear") is LINEAR
    assert colour_space("linear", config) == rgb_space("ACEScg")
    assert colour_space("sRGB", config) is SRGB  # it has none of this name, we have
    monkeypatch.setenv("OCIO", config)
    assert colour_space("linear") == rgb_space("ACEScg")
    assert colour_space("linear", "") is LINEAR
    monkeypatch.setenv("OCIO", "ocio://default")
    assert colour_space("scene_linear") == rgb_space("ACEScg")


def test_names_of_our_own_work_without_opencolorio(bare, measured_rgb):
    for name in ("sRGB", "linear", "lin_rec709", "ACEScg", "Display P3", "Rec.2020", "ACES2065-1"):
        space = colour_space(name)
        again = space.to_linear_srgb(space.from_linear_srgb(measured_rgb))
        assert again.dtype == np.float32
        np.testing.assert_allclose(again, measured_rgb, atol=1e-5)
    message = unknown("ARRI LogC4")
    assert "known are sRGB, linear, ACEScg, Display P3, Rec.2020; others need Open" in message


def test_unknown_names_say_what_is_near(config, monkeypatch):
    monkeypatch.delenv("OCIO", raising=False)
    assert "did you mean ACEScg" in unknown("ACESgc")
    assert "ARRI LogC4" in unknown("arri log c4")
    message = unknown("nonsense")
    assert "sRGB, linear, ACEScg, Display P3, Rec.2020" in message
    assert " more" in message
    assert len(message) < 250
    assert f"in {config}; did you mean reference" in unknown("referense", config)
    assert "\n" not in unknown("two\nlines", config)


def test_siblings():
    acescg = rgb_space("ACEScg")
    assert sibling(SRGB, False) is LINEAR
    assert sibling(LINEAR, True) is SRGB
    assert sibling(P3, False) == P3.with_curve(False)
    assert sibling(P3.with_curve(False), True) is P3
    assert sibling(acescg, True) is SRGB
    assert sibling(acescg, False) is acescg
    assert sibling(rgb_space("Rec.2020"), True) is SRGB
    log = colour_space("ARRI LogC4", "")
    assert sibling(log, True) is log
    assert sibling(log, False) is LINEAR
    wide = RGBSpace("wide", ((0.7, 0.3), (0.2, 0.7), (0.1, 0.05)), (0.3127, 0.329), True)
    assert sibling(wide, False).chromaticities == wide.chromaticities
