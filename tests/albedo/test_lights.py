"""RGB of skin from light to light, by the spectra of a tissue."""

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.albedo.lights import LIKELY, skin_conversion
from cutis.colour import delta_e, light_conversion, reflectance_to_rgb
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, MEASURED2026
from studies.figures.measured import BANDS, measured_skins

LIGHTS = ("A", "D50", "FL2", "FL11", "LED-B3", "LED-RGB1")


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("tissue", [ALIAGA2022, MEASURED2026], ids=lambda t: t.name)
def test_skins_of_the_tissue_are_converted(light, tissue):
    skins = np.random.default_rng(5).uniform(*LIKELY.T, (2000, 5))
    space = albedo_space(tissue)
    seen, true = space.rgb(skins, light), space.rgb(skins)
    errors = delta_e(seen @ skin_conversion(light, tissue).T, true)
    assert errors.mean() < 1.3
    assert errors.mean() < 0.75 * delta_e(seen @ light_conversion(light).T, true).mean()


@pytest.mark.parametrize("light", LIGHTS)
def test_measured_skins_are_converted(light, shared_data):
    skins = measured_skins(shared_data)[::20]
    seen, true = (reflectance_to_rgb(skins, BANDS, name) for name in (light, "D65"))
    errors = delta_e(seen @ skin_conversion(light, MEASURED2026).T, true)
    assert errors.mean() < 0.65 * delta_e(seen @ light_conversion(light).T, true).mean()
    assert errors.mean() < 0.75 * delta_e(seen, true).mean()


def test_d65_and_lights_that_nothing_can_be_balanced_on():
    np.testing.assert_array_equal(skin_conversion("d65", MEASURED2026), np.eye(3))
    with pytest.raises(CutisError, match="unknown illuminant"):
        skin_conversion("candle", MEASURED2026)
