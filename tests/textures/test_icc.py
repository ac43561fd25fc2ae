"""Profiles against littlecms (through Pillow, 8 bit) and the matrices of colour-science."""

import io

import numpy as np
import pytest
from PIL import Image, ImageCms

from cutis.colour import LINEAR, SRGB, decode_srgb, encode_srgb, rgb_space
from cutis.textures.curves import CurveSpace
from cutis.textures.icc import icc_space
from cutis.textures.profile import SRGB_CURVE

STEPS = np.linspace(0, 1, 18)
GRID = np.stack(np.meshgrid(STEPS, STEPS, STEPS), axis=-1).reshape(-1, 3)
CURVES = {
    "identity": ("table", []),
    "gamma 1.8": ("gamma", 1.8),
    "gamma 2.2": ("gamma", 2.19921875),
    "table of 1024": ("table", np.linspace(0, 1, 1024) ** 1.7),
    "table of 2": ("table", [0, 1]),
    "flat ends": ("table", [0, 0, 0.1, 0.4, 1, 1]),
    "para 0": ("para", 0, 2.4),
    "para 1": ("para", 1, 2.0, 1.1, -0.1),
    "para 2": ("para", 2, 2.0, 0.9, -0.05, 0.05),
    "para 3": ("para", 3, *SRGB_CURVE),
    "para 4": ("para", 4, 2.2, 0.9, 0.1, 0.3, 0.1, -0.0002, 0.0215),
}


def curve_of(icc, name):
    kind, *numbers = CURVES[name]
    return getattr(icc, kind)(*numbers)


def by_littlecms(profile, codes):
    """8 bit codes (n, 3) → 8 bit sRGB, relative colorimetric."""
    image = Image.fromarray(codes[None])
    there = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB"))
    here = ImageCms.ImageCmsProfile(io.BytesIO(profile))
    intent = ImageCms.Intent.RELATIVE_COLORIMETRIC
    return np.asarray(ImageCms.profileToProfile(image, here, there, renderingIntent=intent))[0]


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("primaries", ["SRGB", "ADOBE", "PROPHOTO", "P3"])
def test_against_littlecms(icc, name, primaries):
    profile = icc.profile(getattr(icc, primaries), curve_of(icc, name))
    codes = np.rint(GRID * 255).astype(np.uint8)
    expected = by_littlecms(profile, codes).astype(int)
    ours = encode_srgb(icc_space(profile).to_linear_srgb(codes / 255)).clip(0, 1) * 255
    assert abs(ours - expected).max() < 1.6  # their tables have 8 bits, ours do not round
    assert abs(ours - expected).mean() < 0.3


@pytest.mark.parametrize("name", CURVES)
def test_there_and_back(icc, name):
    space = icc_space(icc.profile(icc.ADOBE, curve_of(icc, name)))
    values = GRID[GRID.min(axis=1) >= 0.25] * 0.75  # the flat ends do not come back
    again = space.from_linear_srgb(space.to_linear_srgb(values))
    np.testing.assert_allclose(again, values, atol=1e-9)
    single = space.to_linear_srgb(values.astype(np.float32))
    assert single.dtype == np.float32
    np.testing.assert_allclose(space.from_linear_srgb(single), values, atol=1e-6)


@pytest.mark.parametrize("name", ["gamma 1.8", "gamma 2.2", "table of 1024", "para 3", "para 4"])
def test_measured_skins_come_back(icc, measured_rgb, name):
    for primaries in (icc.SRGB, icc.ADOBE, icc.PROPHOTO, icc.P3):
        space = icc_space(icc.profile(primaries, curve_of(icc, name)))
        again = space.to_linear_srgb(space.from_linear_srgb(measured_rgb))
        np.testing.assert_allclose(again, measured_rgb, atol=1e-5)


@pytest.mark.parametrize(
    ("primaries", "name"),
    [("ADOBE", "Adobe RGB (1998)"), ("PROPHOTO", "ProPhoto RGB"), ("P3", "Display P3")],
)
def test_matrices_against_colour_science(icc, primaries, name):
    import colour

    expected = colour.matrix_RGB_to_RGB(
        colour.RGB_COLOURSPACES[name], colour.RGB_COLOURSPACES["sRGB"], "Bradford"
    )
    space = icc_space(icc.profile(getattr(icc, primaries), icc.gamma(1.5)))
    assert isinstance(space, CurveSpace)
    np.testing.assert_allclose(space.matrix, expected, atol=4e-4)
    np.testing.assert_allclose(space.to_linear_srgb(np.ones(3)), 1, atol=1e-12)


def test_profiles_of_our_own_spaces_are_those(icc):
    made = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    assert icc_space(made) is SRGB
    assert icc_space(icc.profile(icc.SRGB, icc.table(decode_srgb(np.linspace(0, 1, 1024))))) is SRGB
    assert icc_space(icc.profile(icc.SRGB, icc.table([]))) is LINEAR
    assert icc_space(icc.profile(icc.P3, icc.para(3, *SRGB_CURVE))) is rgb_space("Display P3")
    assert isinstance(icc_space(icc.profile(icc.SRGB, icc.gamma(2.2))), CurveSpace)


def test_names(icc):
    assert icc_space(icc.profile(icc.ADOBE, name="a wide one")).name == "a wide one"
    text = "Größe".encode("utf-16-be")
    mluc = b"mluc" + bytes(4) + (1).to_bytes(4, "big") + (12).to_bytes(4, "big") + b"deDE"
    mluc += len(text).to_bytes(4, "big") + (28).to_bytes(4, "big") + text
    assert icc_space(icc.profile(icc.ADOBE, desc=mluc)).name == "Größe"
    for nameless in (None, b"desc", b"mluc\0", b"desc\0\0\0\0\0\0\0\x04\n\n\t\0"):
        found = icc_space(icc.profile(icc.ADOBE, desc=nameless))
        assert found.name == "its ICC profile"


def test_what_cannot_be_used_is_said(icc):
    def refused(data):
        with pytest.raises(ValueError, match=r".") as caught:
            icc_space(data)
        return str(caught.value)

    lab = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB")).tobytes()
    assert refused(lab) == "for Lab colour"
    assert refused(icc.profile(space=b"CMYK")) == "for CMYK colour"
    assert refused(icc.profile(space=b"GRAY")) == "for GRAY colour"
    assert refused(icc.profile(pcs=b"Lab ")) == "a table instead of a matrix and curves"
    assert refused(icc.profile(gTRC=None)) == "a table instead of a matrix and curves"
    assert refused(icc.profile(curve=icc.para(5, 1.0))) == "made of curves of an unknown kind"
    assert refused(icc.profile(curve=b"xxxx" + bytes(8))) == "made of curves of an unknown kind"
    falling, flat = icc.table([1, 0.5, 0]), icc.table([0.5, 0.5])
    damaged = [
        *(icc.profile(curve=curve) for curve in (falling, flat, icc.gamma(0), icc.para(0, -1))),
        icc.profile(curve=icc.para(3, *SRGB_CURVE)[:-6]),
        icc.profile(curve=icc.table(np.linspace(0, 1, 99))[:-5]),
        icc.profile([[0, 0, 0]] * 3),
        icc.profile([icc.D50] * 3),
        icc.profile(rXYZ=b"XYZ \0\0\0\0\0\0\0"),
        b"",
        icc.profile()[:130],
    ]
    for data in damaged:
        assert refused(data) in ("damaged", "for unknown colour"), data[-40:]


def test_any_damage_is_said_or_harmless(icc):
    """A profile with bytes changed or cut gives a space of finite colours, or ValueError."""
    random = np.random.default_rng(3)
    whole = icc.profile(icc.ADOBE, icc.para(3, *SRGB_CURVE))
    refused = 0
    for _ in range(600):
        end = random.integers(0, len(whole) + 1) if random.random() < 0.2 else len(whole)
        data = bytearray(whole[:end])
        for place in random.integers(0, max(len(data), 1), 3):
            data[place : place + 1] = random.bytes(1)
        try:
            space = icc_space(bytes(data))
        except ValueError:
            refused += 1
            continue
        assert np.isfinite(space.to_linear_srgb(GRID)).all()
    assert 50 < refused < 590
