import numpy as np
import pytest

from cutis.render.inversion import diffuse_albedo, single_scattering_albedo
from cutis.render.published_fits import chiang2016, kulla_conty2017, wrenninge2017

ALBEDO = np.linspace(0.02, 0.9, 45)


@pytest.mark.parametrize(
    ("fit", "arguments", "value"),
    [
        # by hand: s = 4.09712 + 2.104315 − √(9.59217 + 20.8404 + 4.42815) = 0.297138
        (kulla_conty2017, (0.5,), 1 - 0.297138**2),
        (kulla_conty2017, (0.5, 0.8), (1 - 0.297138**2) / (1 - 0.8 * 0.297138**2)),
        # 1 − exp(−2.54703 + 0.65297 − 0.539756)
        (chiang2016, (0.5,), 1 - np.exp(-2.433816)),
        # 0.159104 · 1.82605 · atan(2.556234)^1.096861 + 0.840896 · 0.49631 · atan(2.117504)^2.40603
        (wrenninge2017, (0.5,), 0.913701),
    ],
)
def test_quoted_values(fit, arguments, value):
    np.testing.assert_allclose(fit(*arguments), value, atol=2e-6)


def test_each_is_a_fit_to_the_exact_inversion():
    """In diffuse albedo up to 0.9, as docs/subsurface.md has it."""
    for fit, most in ((kulla_conty2017, 0.0025), (chiang2016, 0.03), (wrenninge2017, 0.04)):
        off = diffuse_albedo(fit(ALBEDO)) - ALBEDO
        assert np.abs(off).max() < most
        np.testing.assert_allclose(fit(ALBEDO), single_scattering_albedo(ALBEDO), atol=0.008)


@pytest.mark.parametrize("g", [0.3, 0.6, 0.8])
def test_anisotropic_fits_are_near_the_exact_inversion(g):
    exact = single_scattering_albedo(ALBEDO, g)
    np.testing.assert_allclose(kulla_conty2017(ALBEDO, g), exact, atol=0.01)
    np.testing.assert_allclose(wrenninge2017(ALBEDO, g), exact, atol=0.012)
    off = diffuse_albedo(kulla_conty2017(ALBEDO, g), g) - ALBEDO
    assert np.abs(off).max() < 0.002


def test_what_ends_do():
    np.testing.assert_allclose(kulla_conty2017([0.0, 1.0]), [0, 1], atol=2e-3)
    np.testing.assert_allclose(chiang2016([0.0, 1.0]), [0, 1], atol=2e-3)
    np.testing.assert_allclose(wrenninge2017([0.0, 1.0]), [0, 1], atol=2e-3)
