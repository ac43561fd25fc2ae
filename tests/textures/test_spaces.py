"""Which space a name means, and which a file says."""

import struct
import sys
import zlib

import numpy as np
import OpenImageIO as oiio
import pytest

from cutis.colour import LINEAR, SPACES, SRGB, rgb_space
from cutis.colour.spaces import ACES2065_1, RGBSpace
from cutis.errors import CutisError
from cutis.textures import colour_space, ocio, read_texture
from cutis.textures.spaces import declared_space, sibling

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


def spec_of(**attributes):
    spec = oiio.ImageSpec(4, 4, 3, "half")
    for name, value in attributes.items():
        kind = (oiio.TypeDesc(f"float[{len(value)}]"),) if isinstance(value, tuple) else ()
        spec.attribute(name.replace("__", ":"), *kind, value)
    return spec


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


def test_chromaticities():
    for space in (*SPACES, ACES2065_1):
        given = tuple(round(v, 4) for v in space.chromaticities)
        found, origin = declared_space(spec_of(chromaticities=given), "openexr", True)
        assert found == (space if not space.encoded else space.with_curve(False))
        assert origin == "its chromaticities"
    wide = (0.7347, 0.2653, 0.1152, 0.8264, 0.1566, 0.0177, 0.3457, 0.3585)
    found, _ = declared_space(spec_of(chromaticities=wide), "openexr", True)
    import colour

    theirs = colour.RGB_COLOURSPACES["Adobe Wide Gamut RGB"]
    expected = colour.matrix_RGB_to_RGB(theirs, colour.RGB_COLOURSPACES["sRGB"], "Bradford")
    np.testing.assert_allclose(found.matrix, expected, atol=2e-3)
    for bad in (
        (0.3,) * 8,
        (0.0,) * 8,
        (float("nan"),) * 8,
        (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3, 0),
    ):
        with pytest.raises(ValueError, match="no RGB space"):
            declared_space(spec_of(chromaticities=bad), "openexr", True)


def test_interop_names_do_not_depend_on_the_environment(config, monkeypatch):
    monkeypatch.setenv("OCIO", config)
    found = declared_space(spec_of(colorInteropID="lin_ap1_scene"), "openexr", True)
    assert found == (rgb_space("ACEScg"), "its colorInteropID")
    found = declared_space(spec_of(colorInteropID="lin_moon"), "openexr", True)
    assert found == (LINEAR, "assumed, its colorInteropID 'lin_moon' is not known")
    for nothing in ("unknown", "data"):
        space, origin = declared_space(spec_of(colorInteropID=nothing), "openexr", True)
        assert (space, origin) == (LINEAR, "assumed, the file says nothing")


def png(path, *chunks):
    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0))
    data = chunk(b"IDAT", zlib.compress(bytes(13 * 4))) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + header + b"".join(chunk(*c) for c in chunks) + data)
    return path


@pytest.mark.parametrize(
    ("chunks", "space", "origin"),
    [
        ([], SRGB, "assumed, the file says nothing"),
        ([(b"sRGB", b"\0"), (b"gAMA", struct.pack(">I", 45455))], SRGB, "assumed, the file says"),
        ([(b"gAMA", struct.pack(">I", 45455))], SRGB, "assumed, the file says nothing"),
        ([(b"gAMA", struct.pack(">I", 100000))], LINEAR, "its gAMA"),
        ([(b"gAMA", struct.pack(">I", 55556))], "Gamma 1.8 Encoded Rec.709", "its gAMA"),
        ([(b"cICP", bytes([12, 13, 0, 1]))], P3, "its cICP"),
        ([(b"cICP", bytes([1, 13, 0, 1]))], SRGB, "its cICP"),
        ([(b"cICP", bytes([9, 16, 0, 1]))], SRGB, "assumed, its cICP says pq_rec2020_display"),
    ],
)
def test_what_a_png_says(tmp_path, chunks, space, origin):
    one = read_texture(png(tmp_path / "a.png", *chunks))
    assert space in (one.space, one.space.name)
    assert one.origin.startswith(origin)


@pytest.mark.parametrize(
    ("transfer", "space"), [("Linear", LINEAR), ("Undefined", SRGB), ("ITU-R 709-4", SRGB)]
)
def test_what_a_dpx_says(transfer, space):
    assert declared_space(spec_of(dpx__Transfer=transfer), "dpx", False)[0] == space


@pytest.mark.parametrize("transfer", ["Printing density", "Logarithmic"])
def test_film_densities_need_a_name(transfer):
    with pytest.raises(ValueError, match="--colorspace"):
        declared_space(spec_of(dpx__Transfer=transfer), "dpx", False)


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
