"""Scattering, anisotropy and mixtures against formulae written out by hand (DESIGN, section 2)."""

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutis.optics import ALIAGA2022, WAVELENGTHS, Tissue
from cutis.optics import chromophores as c

share = st.floats(0, 1)


def test_wavelengths():
    assert len(WAVELENGTHS) == 41
    assert (WAVELENGTHS[0], WAVELENGTHS[-1]) == (380, 780)
    assert np.all(np.diff(WAVELENGTHS) == 10)
    with pytest.raises(ValueError, match="read-only"):
        WAVELENGTHS[0] = 0


def test_reduced_scattering():
    """36.4 cm⁻¹ at 500 nm [jacques2013]; the two powers at 700 nm, by hand."""
    assert ALIAGA2022.reduced_scattering(500.0) == pytest.approx(36.4, rel=1e-12)
    assert ALIAGA2022.reduced_scattering(700.0) == pytest.approx(
        36.4 * (0.48 * 1.4**-4 + 0.52 * 1.4**-0.22), rel=1e-12
    )
    assert ALIAGA2022.reduced_scattering(700.0) == pytest.approx(22.126, abs=5e-4)


def test_anisotropy():
    """0.62 + 0.29e-3 λ [vangemert1989]."""
    assert ALIAGA2022.anisotropy(380.0) == pytest.approx(0.7302, abs=1e-12)
    assert ALIAGA2022.anisotropy(780.0) == pytest.approx(0.8462, abs=1e-12)


def test_scattering_is_reduced_over_one_minus_g():
    np.testing.assert_allclose(
        ALIAGA2022.scattering(WAVELENGTHS) * (1 - ALIAGA2022.anisotropy(WAVELENGTHS)),
        ALIAGA2022.reduced_scattering(WAVELENGTHS),
        rtol=1e-14,
    )
    assert ALIAGA2022.scattering(500.0) == pytest.approx(36.4 / 0.235, rel=1e-12)


@settings(max_examples=30, deadline=None)
@given(share, share)
def test_epidermis(melanin, eumelanin):
    lam = WAVELENGTHS
    by_hand = melanin * (
        eumelanin * 6.6e11 * lam**-3.33 + (1 - eumelanin) * 2.9e15 * lam**-4.75
    ) + (1 - melanin) * (c.beta_carotene(lam, 2.1e-4) + 7.84e8 * lam**-3.255)
    got = ALIAGA2022.epidermis_absorption(melanin, eumelanin, lam)
    np.testing.assert_allclose(got, by_hand, rtol=1e-12)


@settings(max_examples=30, deadline=None)
@given(share, share)
def test_dermis(blood, oxygenation):
    """φ_h of the formula is the *de*oxygenated share, 1 − oxygenation."""
    lam, phi = WAVELENGTHS, 1 - oxygenation
    whole = (
        phi * c.deoxyhemoglobin(lam)
        + (1 - phi) * c.oxyhemoglobin(lam)
        + c.bilirubin(lam, 0.05)
        + c.beta_carotene(lam, 7e-5)
    )
    by_hand = blood * whole + (1 - blood) * 7.84e8 * lam**-3.255
    got = ALIAGA2022.dermis_absorption(blood, oxygenation, lam)
    np.testing.assert_allclose(got, by_hand, rtol=1e-12)


def test_shapes_broadcast():
    melanin, eumelanin = np.full((2, 3), 0.1), 0.5
    assert ALIAGA2022.epidermis_absorption(melanin, eumelanin, WAVELENGTHS).shape == (2, 3, 41)
    assert ALIAGA2022.dermis_absorption(0.1, 0.5, 550.0).shape == (1,)


def test_a_tissue_is_a_value():
    assert Tissue("aliaga2022") == ALIAGA2022
    assert hash(Tissue("aliaga2022")) == hash(ALIAGA2022)
    with pytest.raises(FrozenInstanceError):
        ALIAGA2022.hemoglobin = 1.0
    anaemic = replace(ALIAGA2022, name="anaemic", hemoglobin=75.0)
    assert anaemic != ALIAGA2022
    assert ALIAGA2022.hemoglobin == 150.0
    np.testing.assert_allclose(
        anaemic.whole_blood(750.0), np.array(ALIAGA2022.whole_blood(750.0)) / 2, rtol=1e-12
    )


def test_the_papers_choices():
    """Flatland, index-matched, n = 1.4 [aliaga2022]."""
    assert ALIAGA2022.dimension == 2
    assert ALIAGA2022.boundary == "matched"
    assert ALIAGA2022.refractive_index == 1.4
