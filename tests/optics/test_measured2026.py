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
    np.testing.assert_allclose(found, 68.7 * (WAVELENGTHS / 500) ** -1.9, rtol=1e-12)
    assert MEASURED2026.dermis_scattering == 1


def test_melanins_absorb_what_they_did_at_550_nm():
    assert MEASURED2026.eumelanin(550.0) == pytest.approx(ALIAGA2022.eumelanin(550.0))
    assert MEASURED2026.pheomelanin(550.0) == pytest.approx(ALIAGA2022.pheomelanin(550.0))
    steep = np.log(MEASURED2026.eumelanin(500.0) / MEASURED2026.eumelanin(600.0))
    assert steep == pytest.approx(2.57 * np.log(1.2))


def test_oxygenated_blood_is_the_dissolved_ones_in_the_blue():
    """Prahl's below 470 nm, the whole blood of Bosschaart above 490 nm, no step between."""
    table = "bosschaart2014-prahl1999"
    assert MEASURED2026.hemoglobin_table == table
    lam = np.arange(380.0, 781.0)
    blood = c.oxyhemoglobin(lam, table=table)
    dissolved, whole = c.oxyhemoglobin(lam), c.oxyhemoglobin(lam, table="bosschaart2014")
    np.testing.assert_array_equal(blood[lam <= 470], dissolved[lam <= 470])
    np.testing.assert_array_equal(blood[lam >= 490], whole[lam >= 490])
    joined = (lam >= 470) & (lam <= 490)
    assert np.abs(dissolved / whole - 1)[joined].max() < 0.05
    np.testing.assert_array_equal(
        c.deoxyhemoglobin(lam, table=table), c.deoxyhemoglobin(lam, table="bosschaart2014")
    )
    # 524,280 cm⁻¹/(mol/L) at 414 nm [prahl1999hemoglobin]
    by_hand = np.log(10) * 524280 * 150 / 64500
    assert c.oxyhemoglobin(414.0, table=table) == pytest.approx(by_hand)


def test_bands_of_haemoglobin_lie_to_the_blue_of_the_table():
    moved = replace(ALIAGA2022, name="moved", hemoglobin_shift=-2.0, bilirubin=0.0)
    plain = replace(ALIAGA2022, name="plain", bilirubin=0.0)
    lam = np.arange(400.0, 700.0, 2.0)
    for there, here in zip(moved.whole_blood(lam), plain.whole_blood(lam + 2), strict=True):
        np.testing.assert_allclose(there, here, rtol=2e-4)  # carotene stays where it was
    peak = lam[(lam > 560) & (lam < 600)]
    assert peak[moved.whole_blood(peak)[1].argmax()] == 574.0  # 576 nm in the table


def test_carotene_of_lipids_lies_to_the_red_of_that_in_hexane():
    """Its maximum in hexane is at 451 nm [photochemcad]."""
    lam = np.arange(400.0, 551.0)
    without = replace(MEASURED2026, name="without", beta_carotene_epidermis=0.0)
    carotene = MEASURED2026.epidermis_background(lam) - without.epidermis_background(lam)
    assert lam[carotene.argmax()] == pytest.approx(466, abs=1)
    # 139,500 cm⁻¹/(mol/L), 536.87 g/mol
    assert carotene.max() == pytest.approx(np.log(10) * 139500 * 1.6e-3 / 536.87, rel=1e-2)


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
        ({"hemoglobin_shift": np.nan}, "hemoglobin_shift must be within 30 nm"),
        ({"carotene_shift": 31.0}, "carotene_shift must be within 30 nm"),
        ({"vessel_radius": -1.0}, "vessel_radius"),
        ({"vessel_radius": np.nan}, "vessel_radius"),
    ],
)
def test_wrong_constants_are_refused(fields, words):
    with pytest.raises(CutisError, match=words):
        replace(ALIAGA2022, name="wrong", **fields)
