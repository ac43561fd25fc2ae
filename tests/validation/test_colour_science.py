"""Our sums over spectra against colour-science's."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, uniform
from cutis.colour import lab, reflectance_to_rgb, spectrum_to_xyz
from cutis.optics import ALIAGA2022, WAVELENGTHS


@pytest.fixture(scope="module")
def skins():
    return albedo_space(ALIAGA2022).reflectance(uniform(12, seed=3)).astype(float)


def colour_science_xyz(spectrum, light):
    import colour

    shape = colour.SpectralShape(380, 780, 1)
    return (
        colour.sd_to_XYZ(
            colour.SpectralDistribution(spectrum, WAVELENGTHS).align(shape),
            colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape),
            colour.SDS_ILLUMINANTS[light].copy().align(shape),
            method="Integration",
        )
        / 100
    )


@pytest.mark.parametrize("light", ["D65", "A"])
def test_xyz(skins, light):
    """To 1e-3: theirs interpolates the 10 nm bands by Sprague's quintic to 1 nm, ours linearly
    to 5 nm; for spectra as smooth as skin the two rules differ by a few 1e-4."""
    ours = skins @ spectrum_to_xyz(WAVELENGTHS, light)
    theirs = np.array([colour_science_xyz(s, light) for s in skins])
    np.testing.assert_allclose(ours, theirs, atol=1e-3)


def test_rgb_under_d65(skins):
    """To 2e-3 (as above, and their matrix is the rounded one of the standard)."""
    from colour import XYZ_to_sRGB

    theirs = np.array(
        [XYZ_to_sRGB(colour_science_xyz(s, "D65"), apply_cctf_encoding=False) for s in skins]
    )
    np.testing.assert_allclose(reflectance_to_rgb(skins, WAVELENGTHS), theirs, atol=2e-3)


def test_lab_within_the_rounding_of_the_standards_matrix():
    """Theirs from the rounded matrix: greys are up to 0.008 off neutral, ours are neutral."""
    from colour import XYZ_to_Lab, sRGB_to_XYZ

    rgb = np.random.default_rng(1).random((200, 3))
    theirs = XYZ_to_Lab(sRGB_to_XYZ(rgb, apply_cctf_decoding=False), (0.3127, 0.3290))
    np.testing.assert_allclose(lab(rgb), theirs, atol=0.05)
