"""The plain reference by doubling: against the fast form, and on its own."""

import numpy as np
import pytest

from cutis.transport import Layer, adding_doubling, stack_balance


def random_stack(rng):
    """One to three layers whose phase functions and absorption lengths 64 nodes resolve."""
    layers = [
        Layer(
            absorption=float(10 ** rng.uniform(-2, 2.5)),
            scattering=float(10 ** rng.uniform(0, 3)),
            anisotropy=float(rng.uniform(-0.3, 0.85)),
            depth=float(10 ** rng.uniform(-3, 0)),
        )
        for _ in range(rng.integers(1, 4))
    ]
    if rng.random() < 0.6:
        last = layers[-1]
        layers[-1] = Layer(last.absorption, last.scattering, last.anisotropy)
    return layers


@pytest.mark.parametrize("seed", range(48))
def test_agrees_with_discrete_ordinates(seed):
    """Two methods with nothing but Fresnel's formula in common."""
    rng = np.random.default_rng(seed)
    layers = random_stack(rng)
    options = {
        "dimension": 2 + seed % 2,
        "refractive_index": [1.0, 1.4, 1.5][seed % 3],
        "incidence": ["lambertian", 1.0, float(rng.uniform(0.2, 1))][seed // 3 % 3],
    }
    plain = adding_doubling(layers, count=72, **options)
    fast = stack_balance(layers, count=64, **options)
    assert plain == pytest.approx((fast.reflected, fast.transmitted), abs=1e-6), layers


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("index", [1.0, 1.4])
def test_conserves_energy(dimension, index):
    options = {"dimension": dimension, "refractive_index": index, "count": 48}
    for incidence in ("lambertian", 0.6):
        slab = [Layer(0, 80, 0.7, 0.2), Layer(0, 5, 0, 0.3)]
        assert sum(adding_doubling(slab, incidence=incidence, **options)) == pytest.approx(1)
        assert adding_doubling([Layer(0, 80, 0.7)], incidence=incidence, **options) == (
            pytest.approx((1, 0), abs=3e-5)
        )


def test_without_scattering():
    assert adding_doubling([Layer(2, 0, 0, 0.3)], incidence=0.5) == (
        pytest.approx((0, np.exp(-1.2)), abs=1e-9)
    )


def test_a_slab_and_its_halves():
    whole = adding_doubling([Layer(1, 50, 0.5, 0.2)])
    halves = adding_doubling([Layer(1, 50, 0.5, 0.1)] * 2)
    assert whole == pytest.approx(halves, abs=1e-12)


@pytest.mark.parametrize(("dimension", "isotropic"), [(2, 0.45225), (3, 0.41495)])
def test_isotropic_half_space(dimension, isotropic):
    """w = 0.9, normal incidence (shared/references/transport.md, sections 2 and 4)."""
    share, through = adding_doubling([Layer(10, 90)], dimension=dimension, incidence=1.0)
    assert share == pytest.approx(isotropic, abs=1e-5)
    assert through == 0
