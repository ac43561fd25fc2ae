"""Rare chromophores: published coefficients, what they add, and that off is off."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.optics import (
    ALIAGA2022,
    GITLINA2020,
    MEASURED2026,
    PARAMETERS,
    RARE,
    WAVELENGTHS,
    parameter,
    skin,
    tissue_named,
    with_rare_chromophores,
)
from cutis.optics import chromophores as c


def test_methaemoglobin_at_630_nm():
    """15 620 cm⁻¹/M per tetramer [zijlstra2000]: ln 10 · 15 620 · 150 / 64 500 = 83.6 cm⁻¹."""
    assert c.methemoglobin(630.0) == pytest.approx(83.64, abs=0.01)
    assert c.methemoglobin(500.0) == pytest.approx(2.302585 * 36424 * 150 / 64500, rel=1e-6)
    assert c.methemoglobin(630.0, 75.0) == pytest.approx(83.64 / 2, abs=0.01)
    red = np.arange(604.0, 660.0, 2.0)
    assert red[c.methemoglobin(red).argmax()] in (630.0, 632.0)  # the band of its brown
    assert c.methemoglobin(630.0) > 3 * c.deoxyhemoglobin(630.0)


def test_methaemoglobin_goes_on_below_its_table():
    """To the Soret peak at 405 nm, 179 mM⁻¹ cm⁻¹ per haem [antonini1971], without a step."""
    assert c.methemoglobin(405.0) == pytest.approx(2.302585 * 4 * 179e3 * 150 / 64500, rel=1e-6)
    fine = np.arange(380.0, 452.0, 0.01)
    values = c.methemoglobin(fine)
    assert np.all(np.abs(np.diff(np.log(values))) < 0.002)
    below, above = (c.methemoglobin(450 + side) - c.methemoglobin(450.0) for side in (-0.5, 0.5))
    assert -below == pytest.approx(above, rel=0.06)  # the slope of the table
    with pytest.raises(CutisError, match="380-800"):
        c.methemoglobin(379.0)
    with pytest.raises(CutisError, match="outside the table"):
        c.methemoglobin(801.0)


def test_bilirubin_and_carotene_per_gram():
    """ln 10 · 55 000 / 584.66 at 450.8 nm, ln 10 · 139 500 / 536.8726 at 451 nm [photochemcad]."""
    assert c.bilirubin(450.8, 1.0) == pytest.approx(216.6, rel=1e-3)
    assert c.beta_carotene(451.0, 1.0) == pytest.approx(598.3, rel=1e-3)
    for yellow in (c.bilirubin, c.beta_carotene):  # past 550 nm the tables are noise
        assert np.all(yellow(np.arange(550.1, 780), 1.0, c.YELLOW_ENDS) == 0)
        assert yellow(540.0, 1.0, c.YELLOW_ENDS) == yellow(540.0, 1.0)
        assert yellow(560.0, 1.0) < 0.01 * yellow(450.0, 1.0)


@pytest.mark.parametrize("tissue", [ALIAGA2022, MEASURED2026])
def test_what_they_add(tissue):
    lam = np.array([450.0, 451.0, 630.0])
    plain = tissue.dermis_absorption(0.02, 0.7, lam)
    yellow = tissue.dermis_absorption(0.02, 0.7, lam, bilirubin=0.1) - plain
    np.testing.assert_allclose(yellow, c.bilirubin(lam, 0.1, 550.0), atol=1e-12)
    orange = tissue.dermis_absorption(0.02, 0.7, lam, carotene=0.03) - plain
    lipid = lam - tissue.carotene_shift
    np.testing.assert_allclose(orange, c.beta_carotene(lipid, 0.01, 550.0), atol=1e-12)
    above = tissue.epidermis_absorption(0.03, 0.5, lam, carotene=0.03)
    np.testing.assert_allclose(
        above - tissue.epidermis_absorption(0.03, 0.5, lam),
        c.beta_carotene(lipid, 0.03, 550.0),
        atol=1e-12,
    )
    brown = tissue.dermis_absorption(0.02, 0.7, lam, methaemoglobin=0.25) - plain
    none, full = tissue.whole_blood(lam)
    red = 0.7 * full + 0.3 * none
    np.testing.assert_allclose(brown, 0.02 * 0.25 * (tissue.brown_blood(lam) - red), rtol=1e-9)
    stated = lam - tissue.hemoglobin_shift  # instruments are off for all haemoglobin alike
    dissolved = full - c.oxyhemoglobin(stated, 150.0, tissue.hemoglobin_table)
    np.testing.assert_allclose(tissue.brown_blood(lam) - dissolved, c.methemoglobin(stated))


def test_nothing_of_them_is_the_tissue_itself():
    """Bit for bit."""
    share = np.linspace(0.001, 1, 7)
    none = np.zeros(7)
    for tissue in (ALIAGA2022, MEASURED2026):
        args = share, share, WAVELENGTHS
        plain = tissue.dermis_absorption(*args)
        assert np.array_equal(tissue.dermis_absorption(*args, none, none, none), plain)
        plain = tissue.epidermis_absorption(*args)
        assert np.array_equal(tissue.epidermis_absorption(*args, none), plain)


def test_they_are_off_by_default():
    assert not ALIAGA2022.rare_chromophores
    assert ALIAGA2022.parameters == MEASURED2026.parameters == PARAMETERS
    rare = with_rare_chromophores(MEASURED2026)
    assert rare.parameters == (*PARAMETERS, *RARE)
    assert replace(rare, rare_chromophores=False) == MEASURED2026
    assert [p.low for p in RARE] == [0, 0, 0]
    with pytest.raises(CutisError, match="do not go together"):
        with_rare_chromophores(GITLINA2020)
    with pytest.raises(CutisError, match="unknown parameter 'bilirubin' is fixed"):
        replace(ALIAGA2022, fixed=(("bilirubin", 0.1),))


def test_skins_and_names():
    some = skin({"carotene": 0.01}, (*PARAMETERS, *RARE))
    assert list(some[5:]) == [0, 0.01, 0]
    with pytest.raises(CutisError, match="carotene is not a parameter of this tissue"):
        skin({"carotene": 0.01})
    assert parameter("methaemoglobin").high == 0.7
    assert tissue_named("measured2026") is MEASURED2026
    with pytest.raises(CutisError, match="choose aliaga2022 or measured2026"):
        tissue_named("gitlina2020")
