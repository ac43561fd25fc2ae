"""The two-parameter skin: chromophores passed through, monotony, limits, bad input."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo.kubelka_munk import KubelkaMunkSkin
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, WAVELENGTHS
from cutis.transport import Layer, stack_balance
from cutis.transport.kubelka_munk import coefficients, half_space

SKIN = KubelkaMunkSkin(ALIAGA2022)


def test_reflectance_by_hand_at_550_nm():
    """exp(−2 μa,e t) R∞ with the tissue's own coefficients, K = 2 μa, S = ¾ μs′."""
    i = int(np.flatnonzero(WAVELENGTHS == 550)[0])
    epidermis = ALIAGA2022.epidermis_absorption(0.05, 0.61, 550.0).item()
    dermis = ALIAGA2022.dermis_absorption(0.02, 0.75, 550.0).item()
    ratio = 2 * dermis / (0.75 * float(ALIAGA2022.reduced_scattering(550.0)))
    expected = np.exp(-2 * epidermis * 0.02) * (1 + ratio - np.sqrt(ratio**2 + 2 * ratio))
    assert SKIN.reflectance(0.05, 0.02)[i] == pytest.approx(expected, rel=1e-12)


def test_chromophores_pass_through():
    """From the spectra alone: melanin by log of a ratio, blood by (1 − R)² / 2R."""
    light, dark = SKIN.reflectance(np.array([0.02, 0.12]), 0.02)
    pigment = (
        0.61 * ALIAGA2022.eumelanin(WAVELENGTHS)
        + 0.39 * ALIAGA2022.pheomelanin(WAVELENGTHS)
        - ALIAGA2022.epidermis_background(WAVELENGTHS)
    )
    np.testing.assert_allclose(np.log(light / dark), 0.1 * 2 * 0.02 * pigment, rtol=1e-10)
    bare = np.exp(-2 * 0.02 * ALIAGA2022.epidermis_absorption(0.02, 0.61, WAVELENGTHS))
    deep = light / bare
    ratio = (1 - deep) ** 2 / (2 * deep)  # the Kubelka–Munk function is K / S
    dermis = ALIAGA2022.dermis_absorption(0.02, 0.75, WAVELENGTHS)
    reduced = ALIAGA2022.reduced_scattering(WAVELENGTHS)
    np.testing.assert_allclose(ratio * 0.75 * reduced / 2, dermis, rtol=1e-9)


@pytest.mark.parametrize("epidermis", ["absorbing", "scattering"])
def test_more_of_either_is_darker(epidermis):
    skin = KubelkaMunkSkin(ALIAGA2022, epidermis=epidermis)
    axis = np.linspace(0.002, 0.07, 30)
    assert np.all(np.diff(skin.reflectance(axis, 0.02), axis=0) < 0)
    assert np.all(np.diff(skin.reflectance(0.02, axis)[:, 2:30], axis=0) < 0)
    assert skin.rgb(0.02, 0.07)[1] < skin.rgb(0.02, 0.01)[1]
    assert np.all((skin.reflectance(axis, axis) > 0) & (skin.reflectance(axis, axis) < 1))


def test_an_epidermis_like_the_dermis_is_not_there():
    """Where both layers absorb alike, the scattering epidermis leaves a half space of one kind."""
    tissue = replace(ALIAGA2022, beta_carotene_epidermis=0.0)
    skin = KubelkaMunkSkin(tissue, epidermis="scattering")
    absorption = tissue.baseline(WAVELENGTHS)
    k, s = coefficients(absorption, tissue.reduced_scattering(WAVELENGTHS))
    np.testing.assert_allclose(skin.reflectance(0.0, 0.0), half_space(k, s), rtol=1e-12)


def test_two_fluxes_are_near_to_transport_of_the_same_skin():
    """Against the exact solver in 3-D, light to dark, 450 to 750 nm; an epidermis that only absorbs
    leaves out what it would scatter back, and is far off.
    """
    error: dict[str, list[float]] = {"absorbing": [], "scattering": []}
    for melanin in (0.005, 0.02, 0.05, 0.15):
        for i in range(7, 38, 10):
            lam = WAVELENGTHS[i]
            scattering, g = float(ALIAGA2022.scattering(lam)), float(ALIAGA2022.anisotropy(lam))
            above = ALIAGA2022.epidermis_absorption(melanin, 0.61, lam).item()
            below = ALIAGA2022.dermis_absorption(0.02, 0.75, lam).item()
            layers = [Layer(above, scattering, g, 0.02), Layer(below, scattering, g)]
            exact = stack_balance(layers, dimension=3, count=16).reflected
            for name, errors in error.items():
                ours = KubelkaMunkSkin(ALIAGA2022, epidermis=name).reflectance(melanin, 0.02)[i]
                errors.append(abs(ours / exact - 1))
    assert max(error["scattering"]) < 0.13
    assert max(error["absorbing"]) > 0.5
    assert np.mean(error["scattering"]) < 0.2 * np.mean(error["absorbing"])


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: SKIN.reflectance(-0.01, 0.02), "melanin is a volume fraction"),
        (lambda: SKIN.rgb(0.02, np.array([0.1, np.nan])), "blood is a volume fraction"),
        (lambda: KubelkaMunkSkin(ALIAGA2022, conversion="saunderson"), "gate1974"),
        (lambda: KubelkaMunkSkin(ALIAGA2022, epidermis="none"), "absorbing, scattering"),
        (lambda: KubelkaMunkSkin(ALIAGA2022, thickness=2.0), "thickness = 2 is outside"),
        (lambda: KubelkaMunkSkin(ALIAGA2022, blood=(0.07, 0.001)), "blood must rise"),
        (lambda: KubelkaMunkSkin(ALIAGA2022, melanin=(0.0, 0.4)), "melanin = 0 is outside"),
    ],
)
def test_bad_input_is_one_line(make, what):
    with pytest.raises(CutisError, match=what) as caught:
        make()
    assert "\n" not in str(caught.value)
