"""Published and tabulated reflectances, row by row, to the digits they are printed with.

Rows marked *published* are printed in the source named; the others are of an independent
doubling solver (shared/references/transport.md), whose error is about 1e-5 in five digits.
R total includes the specular reflection of light that falls on the surface from outside.
"""

import numpy as np
import pytest
from scipy.integrate import quad

from cutis.transport import Layer, fresnel_reflectance, stack_balance

FIVE_DIGITS = 1.5e-5
SIX_DIGITS = 1e-6
ALBEDOS = (0.5, 0.7, 0.9, 0.95, 0.99, 0.999)


def from_outside(layers, index=1.0, dimension=3, count=64):
    """(R total, R without specular, T, absorbed) of a beam at normal incidence."""
    specular = float(fresnel_reflectance(1.0, index))
    balance = stack_balance(
        layers, dimension=dimension, refractive_index=index, incidence=1.0, count=count
    )
    inside = 1 - specular
    return (
        specular + inside * balance.reflected,
        inside * balance.reflected,
        inside * balance.transmitted,
        inside * balance.absorbed,
    )


def half_space(w, g=0.0):
    return [Layer(1 - w, w, g)]


# --- section 1: three dimensions, published ---------------------------------------------------


def test_van_de_hulst_slab():
    """Van de Hulst 1980, vol. 2, as quoted in the MCML manual [wang1992mcml], table 6.1."""
    total, _, transmitted, _ = from_outside([Layer(10, 90, 0.75, 0.02)])
    assert total == pytest.approx(0.09739, abs=6e-6)
    assert transmitted == pytest.approx(0.66096, abs=6e-6)
    assert transmitted - np.exp(-2) == pytest.approx(0.52562, abs=6e-6)
    assert total == pytest.approx(0.097395, abs=SIX_DIGITS)
    assert transmitted == pytest.approx(0.660958, abs=SIX_DIGITS)
    # Monte Carlo of the same: MCML (standard error as printed) and Prahl et al. 1989
    assert total == pytest.approx(0.09734, abs=3 * 0.00035)
    assert transmitted == pytest.approx(0.66096, abs=3 * 0.00020)
    assert total == pytest.approx(0.09711, abs=3 * 0.00033)
    assert transmitted == pytest.approx(0.66159, abs=3 * 0.00049)


def test_giovanelli_half_space():
    """Giovanelli 1955, 0.2600, is the *total*; the MCML manual's table 6.2 calls it diffuse."""
    total, diffuse, _, _ = from_outside([Layer(10, 90)], index=1.5)
    assert total == pytest.approx(0.2600, abs=1e-4)
    assert diffuse != pytest.approx(0.2600, abs=0.03)
    assert total == pytest.approx(0.25992, abs=FIVE_DIGITS)
    assert diffuse == pytest.approx(0.21992, abs=FIVE_DIGITS)
    assert total == pytest.approx(0.25907, abs=3 * 0.00170)  # MCML
    assert total == pytest.approx(0.26079, abs=3 * 0.00079)  # Prahl et al. 1989


def test_mcml_three_layers():
    """The sample output shipped with MCML, 10⁶ photons, error about 4e-4 [wang1992mcml]."""
    layers = [Layer(1, 100, 0.9, 0.1), Layer(1, 10, 0, 0.1), Layer(2, 10, 0.7, 0.2)]
    _, diffuse, transmitted, absorbed = from_outside(layers, index=1.37)
    assert fresnel_reflectance(1.0, 1.37) == pytest.approx(0.0243729, abs=1e-7)
    assert diffuse == pytest.approx(0.237544, abs=2 * 4e-4)
    assert transmitted == pytest.approx(0.0964896, abs=2 * 4e-4)
    assert absorbed.sum() == pytest.approx(0.641594, abs=2 * 4e-4)
    assert absorbed == pytest.approx([0.2612, 0.1488, 0.2316], abs=1e-3)
    assert diffuse == pytest.approx(0.23786, abs=FIVE_DIGITS)
    assert transmitted == pytest.approx(0.09605, abs=FIVE_DIGITS)


# --- sections 2 and 4: half spaces and slabs ---------------------------------------------------

SPACE = {
    (1.0, 0.0): (0.11523, 0.20868, 0.41495, 0.53554, 0.75272, 0.91285),
    (1.0, 0.5): (0.04754, 0.10422, 0.27778, 0.40388, 0.66461, 0.87797),
    (1.0, 0.8): (0.01477, 0.03654, 0.13621, 0.23895, 0.52191, 0.81307),
    (1.0, 0.9): (0.00646, 0.01604, 0.06857, 0.13864, 0.39954, 0.74595),
    (1.4, 0.0): (0.08008, 0.13182, 0.27838, 0.38691, 0.63137, 0.85790),
    (1.4, 0.5): (0.04643, 0.07380, 0.17986, 0.27593, 0.53050, 0.80708),
    (1.4, 0.8): (0.03295, 0.04191, 0.09313, 0.15713, 0.38586, 0.71755),
    (1.4, 0.9): (0.02992, 0.03346, 0.05730, 0.09539, 0.27868, 0.63161),
}
FLATLAND = {
    (1.0, 0.0): (0.13294, 0.23620, 0.45225, 0.57220, 0.77835, 0.92332),
    (1.0, 0.5): (0.06438, 0.13290, 0.32249, 0.45033, 0.69952, 0.89279),
    (1.0, 0.8): (0.02382, 0.05480, 0.17596, 0.28747, 0.56790, 0.83537),
    (1.0, 0.9): (0.01134, 0.02668, 0.09804, 0.18066, 0.45109, 0.77531),
    (1.4, 0.0): (0.11512, 0.19251, 0.38017, 0.49876, 0.72548, 0.90153),
    (1.4, 0.5): (0.06700, 0.11447, 0.26606, 0.38220, 0.63839, 0.86423),
    (1.4, 0.8): (0.04145, 0.06093, 0.14806, 0.23853, 0.50067, 0.79557),
    (1.4, 0.9): (0.03411, 0.04320, 0.09068, 0.15232, 0.38659, 0.72585),
}


@pytest.mark.parametrize(("dimension", "table"), [(3, SPACE), (2, FLATLAND)])
@pytest.mark.parametrize(("index", "g"), SPACE)
def test_half_spaces(dimension, table, index, g):
    """R total at normal incidence, g by w, n = 1 and 1.4."""
    got = [from_outside(half_space(w, g), index, dimension)[0] for w in ALBEDOS]
    np.testing.assert_allclose(got, table[index, g], atol=FIVE_DIGITS)


@pytest.mark.parametrize(
    ("g", "w", "reflected", "transmitted"),
    [
        (0.00, 0.90, 0.37913, 0.38035),
        (0.00, 0.99, 0.49555, 0.47500),
        (0.00, 1.00, 0.51156, 0.48844),
        (0.75, 0.90, 0.11915, 0.66051),
        (0.75, 0.99, 0.17207, 0.80205),
        (0.75, 1.00, 0.17963, 0.82037),
        (0.90, 0.90, 0.04540, 0.75409),
        (0.90, 0.99, 0.06745, 0.90964),
        (0.90, 1.00, 0.07074, 0.92926),
    ],
)
def test_flatland_slabs(g, w, reflected, transmitted):
    """τ = 2, n = 1, normal incidence; T includes exp(−2)."""
    total, _, through, _ = from_outside([Layer(1 - w, w, g, 2.0)], dimension=2)
    assert total == pytest.approx(reflected, abs=FIVE_DIGITS)
    assert through == pytest.approx(transmitted, abs=FIVE_DIGITS)


def test_flatland_with_surfaces():
    total, _, through, _ = from_outside([Layer(0.1, 0.9, 0.75, 2.0)], index=1.4, dimension=2)
    assert total == pytest.approx(0.14334, abs=FIVE_DIGITS)
    assert through == pytest.approx(0.57808, abs=FIVE_DIGITS)
    assert total == pytest.approx(0.14311, abs=3 * 1e-4)  # Monte Carlo
    assert through == pytest.approx(0.57840, abs=3 * 1.3e-4)
    flat, *_ = from_outside(half_space(0.9), index=1.5, dimension=2)
    assert flat == pytest.approx(0.36959, abs=FIVE_DIGITS)
    assert flat == pytest.approx(0.36948, abs=3 * 2e-4)


# --- section 5: skin-like layers ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("top", "bottom", "flat", "walk", "error", "space"),
    [
        (2.0, 0.3, 0.27730, 0.27692, 0.0002, 0.18409),
        (0.5, 0.3, 0.41064, 0.41119, 0.0004, 0.29868),
        (10.0, 0.3, 0.07783, 0.07783, 0.0002, 0.05169),
        (0.5, 2.0, 0.21475, 0.21515, 0.0004, 0.14149),
    ],
)
def test_skin_like_layers(top, bottom, flat, walk, error, space):
    """n = 1.4; given in mm⁻¹ and mm, here in cm⁻¹ and cm."""
    layers = [Layer(10 * top, 400, 0.9, 0.01), Layer(10 * bottom, 200, 0.8)]
    total, *_ = from_outside(layers, index=1.4, dimension=2)
    assert total == pytest.approx(flat, abs=FIVE_DIGITS)
    assert total == pytest.approx(walk, abs=3 * error)
    assert from_outside(layers, index=1.4)[0] == pytest.approx(space, abs=FIVE_DIGITS)


# --- closed forms --------------------------------------------------------------------------------


def h_function(mu, w, dimension=2):
    """Chandrasekhar's H of the isotropic half space, by its integral [deon2018flatland].

    ln H = −(μ/π) ∫₀^∞ ln Λ(t) / (1 + μ² t²) dt with Λ = 1 − w / √(1+t²) in flatland and
    1 − w atan(t) / t in space; t = tan a turns it into an integral over [0, π/2].
    """

    def integrand(a):
        albedo = np.cos(a) if dimension == 2 else a / np.tan(a)
        return np.log1p(-w * albedo) / (np.cos(a) ** 2 + (mu * np.sin(a)) ** 2)

    if mu == 0:
        return 1.0
    integral, _ = quad(integrand, 0, np.pi / 2, epsabs=1e-10, epsrel=1e-10, limit=400)
    return np.exp(-mu / np.pi * integral)


TABLE = {  # section 4: w: R at μ = 1, 0.5, 0.25, 0.1, R Lambertian, H(1)
    0.1: (0.019334, 0.027220, 0.034583, 0.041960, 0.022731, 1.033713),
    0.3: (0.066858, 0.092226, 0.114980, 0.136897, 0.077749, 1.115319),
    0.5: (0.132943, 0.178414, 0.217103, 0.252569, 0.152397, 1.226204),
    0.7: (0.236197, 0.304228, 0.357856, 0.403820, 0.265201, 1.394508),
    0.8: (0.318168, 0.397239, 0.456166, 0.504385, 0.351828, 1.524623),
    0.9: (0.452252, 0.537910, 0.596558, 0.641509, 0.488691, 1.732131),
    0.95: (0.572198, 0.653162, 0.704875, 0.742578, 0.606666, 1.913190),
    0.99: (0.778354, 0.831486, 0.861945, 0.882613, 0.801050, 2.216458),
    0.999: (0.923319, 0.944126, 0.955258, 0.962500, 0.932238, 2.424861),
    0.9999: (0.975016, 0.982061, 0.985742, 0.988105, 0.978040, 2.498360),
}


@pytest.mark.parametrize("w", TABLE)
def test_flatland_closed_form(w):
    """R(μ) = 1 − √(1−w) H(μ), and its Lambertian average [deon2018flatland]."""
    *collimated, lambertian, h1 = TABLE[w]
    assert h_function(1.0, w) == pytest.approx(h1, abs=SIX_DIGITS)
    for mu, printed in zip((1.0, 0.5, 0.25, 0.1), collimated, strict=True):
        closed = 1 - np.sqrt(1 - w) * h_function(mu, w)
        got = stack_balance(half_space(w), dimension=2, incidence=mu, count=64).reflected
        assert got == pytest.approx(closed, abs=1e-7)
        assert got == pytest.approx(printed, abs=SIX_DIGITS)
    x, weight = np.polynomial.legendre.leggauss(32)
    angle, weight = (x + 1) * np.pi / 4, weight * np.pi / 4
    h = np.array([h_function(float(np.cos(a)), w) for a in angle])
    m0, m1 = 2 / np.pi * weight @ h, 2 / np.pi * weight @ (h * np.cos(angle))
    assert m0 == pytest.approx(2 / w * (1 - np.sqrt(1 - w)), abs=1e-6)
    closed = 1 - np.pi / 2 * np.sqrt(1 - w) * m1
    got = stack_balance(half_space(w), dimension=2, count=64).reflected
    assert got == pytest.approx(closed, abs=1e-6)
    assert got == pytest.approx(lambertian, abs=SIX_DIGITS)


@pytest.mark.parametrize(
    ("w", "values"),
    [
        (0.5, (1, 1.05703, 1.10718, 1.16190, 1.19898, 1.22620)),
        (0.9, (1, 1.13365, 1.27580, 1.46126, 1.60931, 1.73213)),
        (0.99, (1, 1.17387, 1.38055, 1.68514, 1.96122, 2.21646)),
        (1.0, (1, 1.19124, 1.43083, 1.80666, 2.17237, 2.53374)),
    ],
)
def test_h_function_itself(w, values):
    """The oracle above is right: H at μ = 0, 0.1, 0.25, 0.5, 0.75, 1 (section 4)."""
    got = [h_function(mu, w) for mu in (0, 0.1, 0.25, 0.5, 0.75, 1.0)]
    np.testing.assert_allclose(got, values, atol=6e-6)


@pytest.mark.parametrize(
    ("w", "printed"),
    [
        (0.5, 0.115226),
        (0.7, 0.208680),
        (0.9, 0.414947),
        (0.95, 0.535541),
        (0.99, 0.752721),
        (0.999, 0.912845),
    ],
)
def test_chandrasekhar_in_space(w, printed):
    """R = 1 − √(1−w) H(1) at normal incidence, isotropic, matched [chandrasekhar1960]."""
    closed = 1 - np.sqrt(1 - w) * h_function(1.0, w, dimension=3)
    got = from_outside(half_space(w))[0]
    assert closed == pytest.approx(printed, abs=SIX_DIGITS)
    assert got == pytest.approx(closed, abs=1e-7)


def test_chandrasekhar_h_at_one():
    assert h_function(1.0, 1.0, dimension=3) == pytest.approx(2.90781, abs=6e-6)


@pytest.mark.parametrize(("mu", "single"), [(1.0, 0.181690), (0.5, 0.257974), (0.25, 0.330412)])
def test_single_and_double_scattering(mu, single):
    """Orders of scattering from the slope at w = 0 (section 3)."""
    first, second = (
        stack_balance(half_space(w), dimension=2, incidence=mu, count=64).reflected / w
        for w in (1e-3, 2e-3)
    )
    assert 2 * first - second == pytest.approx(single, abs=SIX_DIGITS)
    if mu < 1:
        formula = 0.5 - np.arccosh(1 / mu) / (np.pi * np.sqrt(1 / mu**2 - 1))
        assert single == pytest.approx(formula, abs=SIX_DIGITS)
    else:
        assert single == pytest.approx((np.pi - 2) / (2 * np.pi), abs=SIX_DIGITS)
        assert (second - first) / 1e-3 == pytest.approx((np.pi - 1) / (2 * np.pi**2), abs=5e-4)
