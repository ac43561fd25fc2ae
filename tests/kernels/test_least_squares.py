"""The search for a minimum: compiled against plain, and against SciPy."""

import numpy as np
import pytest
from scipy.optimize import least_squares as scipy_fit

from cutis.kernels import least_squares
from cutis.kernels.compiling import compiled
from cutis.kernels.least_squares_kernel import damped_step, minimise, workspace

RNG = np.random.default_rng(3)
X = np.linspace(0, 2, 25)
RULES = (100, 0.5, 0.2, 5.0, 1e-4, 1e-12, 0.0, 1e-15)


def curve(u, x=X):
    """What is fitted, and its slopes: an exponential that starts, decays and ends somewhere."""
    fade = np.exp(-3 * u[1] * x)
    value = u[0] * fade + u[2]
    return value, np.stack([fade, -3 * x * u[0] * fade, np.ones_like(x)], axis=-1)


@compiled()
def _evaluate(u, problem, a, g):
    x, y = problem
    cost = 0.0
    for p in range(3):
        g[p] = 0.0
        for q in range(3):
            a[p, q] = 0.0
    for i in range(len(x)):
        fade = np.exp(-3 * u[1] * x[i])
        r = u[0] * fade + u[2] - y[i]
        slope = (fade, -3 * x[i] * u[0] * fade, 1.0)
        cost += r * r
        for p in range(3):
            g[p] += slope[p] * r
            for q in range(3):
                a[p, q] += slope[p] * slope[q]
    return cost


def plain(u, y):
    value, slope = curve(u)
    r = value - y
    return float(r @ r), slope.T @ slope, slope.T @ r


def found(y, start, held=(False, False, False), low=0.0):
    u, work = np.array(start), workspace(3)
    ends = np.full(3, low), np.ones(3)
    cost = minimise(_evaluate, (X, y), u, *ends, np.array(held), RULES, work)
    same, its_cost = least_squares.minimise(
        lambda v: plain(v, y), np.array(start), *ends, np.array(held), RULES
    )
    np.testing.assert_allclose(u, same, atol=1e-6)
    assert cost == pytest.approx(its_cost, rel=1e-6, abs=1e-15)
    value, matrix, _ = plain(u, y)
    assert cost == pytest.approx(value, rel=1e-9, abs=1e-18)
    np.testing.assert_allclose(work[0][0], matrix, rtol=1e-9)  # that of the end
    return u, cost


@pytest.mark.parametrize("case", range(8))
def test_inside_the_bounds_it_is_scipys_minimum(case):
    truth = RNG.uniform(0.2, 0.8, 3)
    y = curve(truth)[0] + 0.01 * RNG.standard_normal(len(X))
    u, cost = found(y, [0.5, 0.5, 0.5])
    solved = scipy_fit(lambda v: curve(v)[0] - y, [0.5] * 3, bounds=(0, 1), xtol=1e-15, ftol=1e-15)
    np.testing.assert_allclose(u, solved.x, atol=1e-5)
    assert cost == pytest.approx(2 * solved.cost, rel=1e-8)


def test_on_a_bound_it_is_scipys_minimum_too():
    y = curve(np.array([0.5, 0.4, -0.2]))[0]
    u, cost = found(y, [0.5, 0.5, 0.5])
    solved = scipy_fit(lambda v: curve(v)[0] - y, [0.5] * 3, bounds=(0, 1), xtol=1e-15, ftol=1e-15)
    assert u[2] == 0
    assert cost == pytest.approx(2 * solved.cost, rel=1e-6)


def test_what_is_held_stays():
    y = curve(np.array([0.5, 0.4, 0.2]))[0]
    u, _ = found(y, [0.3, 0.9, 0.2], held=(False, True, False))
    assert u[1] == 0.9
    assert u[0] != 0.3


def test_steps():
    a = np.diag([1.0, 2.0, 4.0]) + 0.1
    g, step, factor = np.array([1.0, -2.0, 3.0]), np.empty(3), np.empty((3, 3))
    damped_step(a, g, np.array([True] * 3), 0.5, factor, step)
    np.testing.assert_allclose(step, -np.linalg.solve(a + 0.5 * np.diag(np.diag(a)), g))
    damped_step(a, g, np.array([True, False, True]), 0.0, factor, step)
    np.testing.assert_allclose(step[[0, 2]], -np.linalg.solve(a[::2, ::2], g[::2]))
    assert step[1] == 0
