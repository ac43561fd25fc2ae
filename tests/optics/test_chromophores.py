"""Every coefficient at a quoted wavelength, so that a slip of a factor cannot hide."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.optics import chromophores as c


def test_melanins_at_550_nm():
    """6.6e11 · 550^−3.33 and 2.9e15 · 550^−4.75 cm⁻¹ [donner2006]."""
    assert c.eumelanin(550.0) == pytest.approx(494.5, rel=1e-4)
    assert c.pheomelanin(550.0) == pytest.approx(279.0, rel=2e-4)


def test_melanins_cross():
    """Equal where λ^1.42 = 2.9e15 / 6.6e11, at 367.6 nm; eumelanin absorbs more beyond."""
    equal = (2.9e15 / 6.6e11) ** (1 / 1.42)
    assert c.eumelanin(equal) == pytest.approx(c.pheomelanin(equal), rel=1e-12)
    assert equal == pytest.approx(367.6, abs=0.1)
    assert c.eumelanin(700.0) > c.pheomelanin(700.0)


def test_baseline_at_550_nm():
    """7.84e8 · 550^−3.255 cm⁻¹ [saidi1992]."""
    assert c.baseline(550.0) == pytest.approx(0.9428, rel=1e-4)


@pytest.mark.parametrize(
    ("substance", "wavelength", "molar", "absorption"),
    [
        # cm⁻¹/(mol/L) of [prahl1999hemoglobin]; cm⁻¹ at 150 g/L: ln 10 · ε · 150 / 64 500
        (c.oxyhemoglobin, 542.0, 53292.0, 285.37),
        (c.oxyhemoglobin, 576.0, 55540.0, 297.41),
        (c.deoxyhemoglobin, 556.0, 54540.0, 292.05),
    ],
)
def test_haemoglobin_peaks(substance, wavelength, molar, absorption):
    assert substance(wavelength) == pytest.approx(absorption, abs=0.005)
    assert substance(wavelength) == pytest.approx(2.302585093 * molar * 150 / 64500, rel=1e-9)
    assert substance(wavelength, 75.0) == pytest.approx(absorption / 2, abs=0.005)
    around = substance(wavelength + np.array([-4.0, -2.0, 0.0, 2.0, 4.0]))
    assert around.argmax() == 2


@pytest.mark.parametrize("point", [500.0, 530.0, 546.0, 570.0, 584.0])
def test_isosbestic_points(point):
    """Oxygenation does not matter near 500, 530, 546, 570, 584 nm [prahl1999hemoglobin]."""
    around = np.arange(point - 3, point + 3.01, 0.05)
    difference = c.oxyhemoglobin(around) - c.deoxyhemoglobin(around)
    assert np.abs(difference).min() < 1
    assert np.sign(difference[0]) == -np.sign(difference[-1])


def test_deoxygenated_blood_absorbs_more_red():
    assert c.deoxyhemoglobin(660.0) > 8 * c.oxyhemoglobin(660.0)


def test_bilirubin_peak():
    """55 000 cm⁻¹/M at 450.8 nm [photochemcad]: ln 10 · 55 000 · 0.05 / 584.66 = 10.83 cm⁻¹."""
    lam = np.arange(440.0, 460.0, 0.25)
    assert c.bilirubin(450.8) == pytest.approx(10.83, abs=0.005)
    assert c.bilirubin(450.8) * 584.66 / (0.05 * c.LN10) == pytest.approx(55000, rel=1e-3)
    assert c.bilirubin(lam).max() == pytest.approx(10.83, abs=0.05)
    assert c.bilirubin(450.8, 0.1) == pytest.approx(2 * c.bilirubin(450.8))


def test_beta_carotene_peak():
    """139 500 cm⁻¹/M at 451 nm [photochemcad]: ln 10 · 139 500 · 2.1e-4 / 536.8726."""
    assert c.beta_carotene(450.99) == pytest.approx(0.12564, abs=5e-6)
    assert c.beta_carotene(450.99) * 536.8726 / (2.1e-4 * c.LN10) == pytest.approx(139500)
    lam = np.arange(430.0, 500.0, 0.25)
    assert lam[c.beta_carotene(lam).argmax()] == pytest.approx(451, abs=0.3)
    assert c.beta_carotene(451.0, 7e-5) == pytest.approx(c.beta_carotene(451.0) / 3)


@pytest.mark.parametrize("substance", [c.bilirubin, c.beta_carotene])
def test_nothing_past_700_nm(substance):
    assert np.all(substance([700.5, 720.0, 780.0, 1000.0]) == 0)
    assert np.all(substance(np.arange(380.0, 781.0)) >= 0)


@pytest.mark.parametrize(
    ("substance", "wavelength"),
    [
        (c.oxyhemoglobin, 240.0),
        (c.deoxyhemoglobin, 1010.0),
        (c.bilirubin, 200.0),
        (c.beta_carotene, 0.5),
    ],
)
def test_outside_a_table_is_one_line(substance, wavelength):
    with pytest.raises(CutisError, match="nm") as caught:
        substance([500.0, wavelength])
    assert "\n" not in str(caught.value)


def test_shapes():
    lam = np.array([[400.0, 500.0, 600.0], [450.0, 550.0, 650.0]])
    for substance in (c.eumelanin, c.baseline, c.oxyhemoglobin, c.bilirubin):
        assert substance(lam).shape == (2, 3)
        assert substance(500.0).shape == ()
        assert substance([]).shape == (0,)
