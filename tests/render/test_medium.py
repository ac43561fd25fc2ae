import numpy as np
import pytest

from cutis.colour import reflectance_to_rgb
from cutis.maps import skin_of
from cutis.optics import NAMES, WAVELENGTHS
from cutis.optics.tissue import ALIAGA2022
from cutis.render.medium import mean_free_path, mean_free_path_in, of_maps

RNG = np.random.default_rng(4)
SHAPE = (30, 20)


def maps(mask=None):
    def one(low, high):
        return RNG.uniform(low, high, SHAPE).astype(np.float32)

    mask = np.ones(SHAPE, np.float32) if mask is None else mask
    ranges = ((0.001, 0.5), (0.001, 1.0), (10, 250), (0.1, 1), (0, 0.999))
    return skin_of({n: one(*ends) for n, ends in zip(NAMES, ranges, strict=True)}, mask)


def test_lengths_of_the_published_scattering():
    """36.4 (0.48 (λ/500)⁻⁴ + 0.52 (λ/500)^−0.22) cm⁻¹: 46.0 at 450 nm, 26.6 at 600 nm."""
    at = ALIAGA2022.reduced_scattering([450, 600])
    np.testing.assert_allclose(at, [46.0, 26.6], atol=0.1)
    lengths = 10 / ALIAGA2022.reduced_scattering(WAVELENGTHS)
    np.testing.assert_allclose(mean_free_path(ALIAGA2022), reflectance_to_rgb(lengths, WAVELENGTHS))
    np.testing.assert_allclose(mean_free_path(ALIAGA2022), [0.415, 0.321, 0.208], atol=5e-4)


def test_a_spectrum_that_ends_in_the_blue_does_not_make_negative_lengths():
    bands = mean_free_path_in(ALIAGA2022, 0.9, 0.9)
    assert (bands > 0).all()


def test_a_walk_ahead_takes_shorter_steps():
    np.testing.assert_allclose(mean_free_path(ALIAGA2022, 0.8), 0.2 * mean_free_path(ALIAGA2022))


def test_absorption_shortens_paths():
    bloodless = mean_free_path_in(ALIAGA2022, 0.0, 0.7)
    assert (bloodless < mean_free_path(ALIAGA2022)).all()
    np.testing.assert_allclose(
        bloodless, mean_free_path(ALIAGA2022), rtol=0.06
    )  # the baseline is weak
    rich = mean_free_path_in(ALIAGA2022, 0.2, 0.7)
    assert (rich < bloodless).all()
    assert rich[0] / bloodless[0] > 1.5 * rich[2] / bloodless[2]  # blood absorbs blue


def test_maps_come_from_a_table_close_to_the_formula():
    mask = np.ones(SHAPE, np.float32)
    mask[:, 0] = 0
    skin = maps(mask)
    found = of_maps(skin, 0.5)
    assert found.dtype == np.float32
    formula = mean_free_path_in(skin.tissue, skin.blood, skin.oxygenation, 0.5)
    np.testing.assert_allclose(found[:, 1:], formula[:, 1:], rtol=2e-3)
    off = np.tile(mean_free_path(skin.tissue, 0.5), (30, 1))
    np.testing.assert_allclose(found[:, 0], off, rtol=1e-6)


@pytest.mark.parametrize("melanin", [0.01, 0.3])
def test_melanin_shortens_none(melanin):
    skin = maps()
    again = skin.replace(melanin=melanin)
    np.testing.assert_array_equal(of_maps(skin), of_maps(again))
