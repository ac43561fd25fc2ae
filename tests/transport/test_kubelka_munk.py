"""Two-flux theory: closed forms, its equations integrated, and how near it comes to transport."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from cutis.errors import CutisError
from cutis.transport import Layer, stack_balance
from cutis.transport.kubelka_munk import CONVERSIONS, coefficients, half_space, layer, over


def test_half_space_is_the_printed_formula():
    ratio = np.geomspace(1e-4, 1e4, 40)
    printed = 1 + ratio - np.sqrt(ratio**2 + 2 * ratio)
    np.testing.assert_allclose(half_space(ratio, 1.0), printed, rtol=1e-3, atol=1e-9)
    np.testing.assert_allclose(half_space(0.5, 1.0), 1.5 - np.sqrt(1.25), rtol=1e-14)
    assert half_space(0.0, 3.0) == 1.0
    assert half_space(2.0, 0.0) == 0.0


def test_limits_of_a_layer():
    r, t = layer(0.0, 50.0, 0.03)  # no absorption
    np.testing.assert_allclose([r, t], [1.5 / 2.5, 1 / 2.5], rtol=1e-12)
    r, t = layer(20.0, 0.0, 0.03)  # no scattering
    np.testing.assert_allclose([r, t], [0.0, np.exp(-0.6)], rtol=1e-12)
    r, t = layer(2.0, 30.0, np.inf)
    np.testing.assert_allclose([r, t], [half_space(2.0, 30.0), 0.0], rtol=1e-12)
    for k in 10.0 ** np.arange(-16, -9):  # the limit is reached smoothly
        np.testing.assert_allclose(layer(k, 50.0, 0.03), [0.6, 0.4], rtol=1e-10)
    assert layer(0.0, 50.0, np.inf) == (1.0, 0.0)  # neither: all comes back from infinity
    assert layer(0.0, 0.0, np.inf) == (0.0, 1.0)
    assert layer(3.0, 50.0, 0.0) == (0.0, 1.0)


def test_over_black_and_white():
    """Against the printed form with hyperbolic cotangent."""
    r, t = layer(4.0, 60.0, 0.02)
    assert over(r, t, 0.0) == r
    # printed form of a layer upon a background: a = 1 + K/S, b = √(a² − 1) [kubelka1948]
    a = 1 + 4.0 / 60.0
    b = np.sqrt(a * a - 1)
    coth = 1 / np.tanh(b * 60.0 * 0.02)
    for background in (0.2, 1.0):
        printed = (1 - background * (a - b * coth)) / (a - background + b * coth)
        np.testing.assert_allclose(over(r, t, background), printed, rtol=1e-12)
    assert over(1.0, 0.0, 1.0) == 1.0


@pytest.mark.parametrize(("k", "s", "d"), [(3.0, 40.0, 0.05), (30.0, 10.0, 0.1), (0.1, 80.0, 0.02)])
def test_the_equations_themselves(k, s, d):
    """i' = −(K + S) i + S j, −j' = −(K + S) j + S i, one unit in at the top, none at the bottom."""
    solved = solve_bvp(
        lambda x, y: np.stack([-(k + s) * y[0] + s * y[1], (k + s) * y[1] - s * y[0]]),
        lambda top, bottom: np.array([top[0] - 1, bottom[1]]),
        np.linspace(0, d, 50),
        np.ones((2, 50)),
        tol=1e-8,
    )
    r, t = layer(k, s, d)
    np.testing.assert_allclose([r, t], [solved.y[1, 0], solved.y[0, -1]], rtol=1e-6)


def test_energy_and_adding():
    rng = np.random.default_rng(1)
    k, s, d = rng.uniform(0.01, 50, (3, 200)) * np.array([[1.0], [2.0], [0.01]])
    r, t = layer(k, s, d)
    assert np.all((r > 0) & (t > 0) & (r + t < 1))
    # half upon half is the whole, over any background
    half = layer(k, s, d / 2)
    for background in (0.0, 0.3, 1.0):
        whole = over(r, t, background)
        np.testing.assert_allclose(over(*half, over(*half, background)), whole, rtol=1e-10)
    # and a half space does not notice a layer of itself
    deep = half_space(k, s)
    np.testing.assert_allclose(over(r, t, deep), deep, rtol=1e-10)


@pytest.mark.parametrize("ratio", [1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0])
def test_gate_is_near_to_transport(ratio):
    """Half space, 3-D, Lambertian: within 3.3 % of the exact solver, nearer than the others."""
    absorption, reduced = 20 * ratio, 20.0
    exact = stack_balance([Layer(absorption, 100.0, 0.8)], dimension=3).reflected
    error = {
        name: abs(float(half_space(*coefficients(absorption, reduced, name))) / exact - 1)
        for name in CONVERSIONS
    }
    assert error["gate1974"] < 0.033
    assert error["gate1974"] <= error["star1988"] < error["plain"]


@pytest.mark.parametrize(
    ("call", "given", "what"),
    [
        (coefficients, (-1.0, 10.0), "negative"),
        (coefficients, (1.0, -10.0), "negative"),
        (coefficients, (np.nan, 10.0), "finite"),
        (coefficients, (0.0, 0.0), "both be zero"),
        (coefficients, (1.0, 1.0, "saunderson"), "gate1974"),
        (half_space, (0.0, 0.0), "both be zero"),
        (half_space, (-1.0, 1.0), "negative"),
        (layer, (1.0, np.inf, 1.0), "finite"),
        (layer, (1.0, 1.0, np.nan), "depth"),
        (layer, (1.0, 1.0, -0.1), "depth"),
        (over, (1.2, 0.0, 0.5), "0 to 1"),
    ],
)
def test_bad_input_is_one_line(call, given, what):
    with pytest.raises(CutisError, match=what) as caught:
        call(*given)
    assert "\n" not in str(caught.value)
