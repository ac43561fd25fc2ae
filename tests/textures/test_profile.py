"""Profiles that we write, as littlecms and our own reader understand them."""

import io

import numpy as np
import pytest
from PIL import Image, ImageCms

from cutis.colour import SPACES, encode_srgb
from cutis.colour.spaces import ACES2065_1, RGBSpace
from cutis.textures.icc import icc_space
from cutis.textures.profile import icc_profile

OURS = (*SPACES, ACES2065_1)


@pytest.mark.parametrize("space", OURS, ids=lambda space: space.name)
def test_they_are_read_as_what_they_are(space):
    assert icc_space(icc_profile(space)) is space
    assert icc_profile(space) == icc_profile(space)


def test_another_space():
    adobe = RGBSpace("wide", ((0.64, 0.33), (0.21, 0.71), (0.15, 0.06)), (0.3127, 0.329), True)
    found = icc_space(icc_profile(adobe))
    assert found.name == "wide"
    values = np.random.default_rng(0).uniform(0, 1, (99, 3))
    np.testing.assert_allclose(
        found.to_linear_srgb(values), adobe.to_linear_srgb(values), atol=1e-4
    )


@pytest.mark.parametrize("space", OURS, ids=lambda space: space.name)
def test_littlecms_gives_the_same_colours(space):
    profile = ImageCms.ImageCmsProfile(io.BytesIO(icc_profile(space)))
    assert ImageCms.getProfileDescription(profile).strip() == space.name
    srgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB"))
    codes = np.random.default_rng(1).integers(0, 256, (1, 500, 3)).astype(np.uint8)
    intent = ImageCms.Intent.RELATIVE_COLORIMETRIC
    there = ImageCms.profileToProfile(Image.fromarray(codes), profile, srgb, renderingIntent=intent)
    ours = encode_srgb(space.to_linear_srgb(codes / 255)).clip(0, 1) * 255
    assert abs(ours - np.asarray(there).astype(int)).max() < 1.6
