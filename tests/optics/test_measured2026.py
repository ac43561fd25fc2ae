"""The calibrated tissue: its constants are the published ones that it names."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, MEASURED2026, WAVELENGTHS
from cutis.optics import chromophores as c


def test_baseline_is_that_of_jacques_with_half_its_exponential():
    np.testing.assert_allclose(
        MEASURED2026.baseline(WAVELENGTHS),
        c.baseline_jacques(WAVELENGTHS, 0.244, 42.6),
        rtol=1e-12,
    )


def test_scattering_is_a_power_law_of_both_layers():
    """68.7 cm⁻¹ at 500 nm, the strongest skin of [jacques2013]."""
    found = MEASURED2026.reduced_scattering(WAVELENGTHS)
    np.testing.assert_allclose(found, 68.7 * (WAVELENGTHS / 500) ** -1.8, rtol=1e-12)
    assert MEASURED2026.dermis_scattering == 1


def test_melanins_absorb_what_they_did_at_550_nm():
    assert MEASURED2026.eumelanin(550.0) == pytest.approx(ALIAGA2022.eumelanin(550.0))
    assert MEASURED2026.pheomelanin(550.0) == pytest.approx(ALIAGA2022.pheomelanin(550.0))
    steep = np.log(MEASURED2026.eumelanin(500.0) / MEASURED2026.eumelanin(600.0))
    assert steep == pytest.approx(2.7 * np.log(1.2))


@pytest.mark.parametrize(
    ("substance", "wavelength", "absorption"),
    [
        # mm⁻¹ at haematocrit 45 % [bosschaart2014], in cm⁻¹
        (c.oxyhemoglobin, 380.0, 478.6),
        (c.oxyhemoglobin, 540.0, 271.3),
        (c.deoxyhemoglobin, 560.0, 265.6),
        (c.deoxyhemoglobin, 620.0, 28.2),
    ],
)
def test_whole_blood(substance, wavelength, absorption):
    found = substance(wavelength, 150.0, "bosschaart2014")
    assert found == pytest.approx(absorption, abs=0.05)
    assert substance(wavelength, 75.0, "bosschaart2014") == pytest.approx(found / 2)


def test_the_tables_of_haemoglobin_agree_where_light_is_well_measured():
    lam = np.arange(500.0, 601.0, 10.0)
    for substance in (c.oxyhemoglobin, c.deoxyhemoglobin):
        ratio = substance(lam, 150.0, "bosschaart2014") / substance(lam)
        assert 0.85 < np.median(ratio) < 1.1


def test_blood_in_vessels_shades_itself():
    free = replace(ALIAGA2022, name="free").whole_blood(WAVELENGTHS)[1]
    packed = replace(ALIAGA2022, name="packed", vessel_radius=20.0).whole_blood(WAVELENGTHS)[1]
    dissolved = free - c.oxyhemoglobin(WAVELENGTHS)
    depth = 2 * 20e-4 * c.oxyhemoglobin(WAVELENGTHS)
    by_hand = c.oxyhemoglobin(WAVELENGTHS) * (1 - np.exp(-depth)) / depth + dissolved
    np.testing.assert_allclose(packed, by_hand, rtol=1e-10)
    thin = replace(ALIAGA2022, name="thin", vessel_radius=1e-6).whole_blood(WAVELENGTHS)[1]
    np.testing.assert_allclose(thin, free, rtol=1e-6)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"hemoglobin_table": "prahl"}, "hemoglobin_table must be"),
        ({"vessel_radius": -1.0}, "vessel_radius"),
        ({"vessel_radius": np.nan}, "vessel_radius"),
    ],
)
def test_wrong_constants_are_refused(fields, words):
    with pytest.raises(CutisError, match=words):
        replace(ALIAGA2022, name="wrong", **fields)
