"""The exact solver: conservation, reciprocity, limits, convergence, batches, bad input.

Published numbers are in tests/validation/test_transport_tables.py.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, WAVELENGTHS
from cutis.transport import Layer, adding_doubling, stack_balance, two_layer_albedo

PROBLEMS = [(2, 1.0), (2, 1.4), (3, 1.0), (3, 1.4)]


def reflected(layers, **options):
    return stack_balance(layers, **options).reflected


def exponent(low, high):
    return st.floats(low, high).map(lambda x: 10.0**x)


layer = st.builds(
    Layer,
    absorption=st.one_of(st.just(0.0), exponent(-6, 4)),
    scattering=exponent(-1, 3.5),
    anisotropy=st.floats(-0.6, 0.95),
    depth=exponent(-4, 1),
)
bottom = st.builds(
    Layer,
    absorption=st.one_of(st.just(0.0), exponent(-4, 4)),
    scattering=exponent(-1, 3.5),
    anisotropy=st.floats(-0.6, 0.95),
)
stacks = st.one_of(
    st.lists(layer, min_size=1, max_size=4),
    st.tuples(st.lists(layer, max_size=3), bottom).map(lambda pair: [*pair[0], pair[1]]),
)
options = st.fixed_dictionaries(
    {
        "dimension": st.sampled_from([2, 3]),
        "refractive_index": st.sampled_from([1.0, 1.2, 1.4, 1.5]),
        "incidence": st.sampled_from(["lambertian", 1.0, 0.5, 0.1]),
    }
)


@settings(max_examples=200, deadline=None)
@given(stacks, options)
def test_energy_is_conserved(layers, chosen):
    """Absorption is integrated from the radiance inside, so this is not a tautology."""
    balance = stack_balance(layers, count=16, **chosen)
    total = balance.reflected + balance.transmitted + balance.absorbed.sum()
    assert abs(total - 1) <= 1e-10
    assert np.all(balance.absorbed >= -1e-12)
    assert -1e-12 <= balance.reflected <= 1 + 1e-10
    assert -1e-12 <= balance.transmitted <= 1 + 1e-10


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
@pytest.mark.parametrize("incidence", ["lambertian", 0.7])
def test_nothing_is_lost_where_nothing_absorbs(dimension, index, incidence):
    chosen = {"dimension": dimension, "refractive_index": index, "incidence": incidence}
    deep = stack_balance([Layer(0, 100, 0.8)], **chosen)
    assert deep.reflected == pytest.approx(1, abs=1e-10)
    assert deep.absorbed[0] == 0
    slab = stack_balance([Layer(0, 100, 0.8, 0.1), Layer(0, 3, -0.2, 5.0)], **chosen)
    assert slab.reflected + slab.transmitted == pytest.approx(1, abs=1e-10)
    assert np.all(slab.absorbed == 0)


def test_only_absorbed_below_a_clear_layer():
    balance = stack_balance([Layer(0, 50, 0.5, 0.1), Layer(3, 50, 0.5)])
    assert balance.absorbed[0] == 0
    assert balance.absorbed[1] == pytest.approx(1 - balance.reflected, abs=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_beer_lambert_without_scattering(dimension):
    """A beam through an absorber: exp(−μa d / μ), no reflection."""
    balance = stack_balance([Layer(2.0, 0, 0, 0.3)], dimension=dimension, incidence=0.5)
    assert balance.reflected == pytest.approx(0, abs=1e-12)
    assert balance.transmitted == pytest.approx(np.exp(-2.0 * 0.3 / 0.5), abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.lists(layer, min_size=2, max_size=3), st.sampled_from([2, 3]))
def test_transmission_is_reciprocal(layers, dimension):
    """Matched: a Lambertian lobe gets through a stack and through the stack upside down alike."""
    there = stack_balance(layers, dimension=dimension, count=16).transmitted
    back = stack_balance(layers[::-1], dimension=dimension, count=16).transmitted
    assert there == pytest.approx(back, abs=1e-11)


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
def test_lambertian_is_an_average_over_beams(dimension, index):
    layers = [Layer(2, 400, 0.8, 0.01), Layer(1, 200, 0.7)]
    s, weight = np.polynomial.legendre.leggauss(24)
    angle = (s + 1) * np.pi / 4
    weight = weight * np.cos(angle) * (np.sin(angle) if dimension == 3 else 1)
    chosen = {"dimension": dimension, "refractive_index": index, "count": 40}
    beams = [reflected(layers, incidence=float(np.cos(a)), **chosen) for a in angle]
    assert weight @ beams / weight.sum() == pytest.approx(reflected(layers, **chosen), abs=1e-6)


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
def test_only_optical_depths_matter(dimension, index):
    chosen = {"dimension": dimension, "refractive_index": index}
    here = stack_balance([Layer(2, 300, 0.8, 0.01), Layer(1, 100, 0.7, 0.2)], **chosen)
    there = stack_balance([Layer(20, 3000, 0.8, 0.001), Layer(10, 1000, 0.7, 0.02)], **chosen)
    assert here.reflected == pytest.approx(there.reflected, abs=1e-13)
    assert here.transmitted == pytest.approx(there.transmitted, abs=1e-13)
    np.testing.assert_allclose(here.absorbed, there.absorbed, atol=1e-13)


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
def test_a_layer_cut_in_two_is_the_same(dimension, index):
    chosen = {"dimension": dimension, "refractive_index": index}
    whole = stack_balance([Layer(2, 300, 0.8, 0.03), Layer(1, 100, 0.7)], **chosen)
    cut = stack_balance(
        [Layer(2, 300, 0.8, 0.01), Layer(2, 300, 0.8, 0.02), Layer(1, 100, 0.7)], **chosen
    )
    assert whole.reflected == pytest.approx(cut.reflected, abs=1e-13)
    assert whole.absorbed[0] == pytest.approx(cut.absorbed[:2].sum(), abs=1e-13)
    half_space = stack_balance([Layer(1, 100, 0.7, 0.5), Layer(1, 100, 0.7)], **chosen)
    one = stack_balance([Layer(1, 100, 0.7)], **chosen)
    assert half_space.reflected == pytest.approx(one.reflected, abs=1e-13)


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
def test_thin_and_thick_epidermis(dimension, index):
    """t → 0 is the dermis alone, t → ∞ the epidermis alone; no depth overflows."""
    chosen = {"dimension": dimension, "refractive_index": index}
    dermis, over = Layer(1, 200, 0.8), Layer(30, 200, 0.8)
    alone = reflected([dermis], count=24, **chosen)
    microns = np.array([1e-6, 1e-3, 1e-2, 1e-1])
    thin = two_layer_albedo([30], [1], microns, 200, 0.8, **chosen).ravel()
    assert thin[0] == pytest.approx(alone, abs=1e-7)
    slope = (alone - thin[1:]) / microns[1:]  # darker in proportion to t
    np.testing.assert_allclose(slope, slope[0], rtol=1e-2)
    thick = two_layer_albedo([30], [1], [1e5, 1e9, 1e15], 200, 0.8, **chosen).ravel()
    np.testing.assert_allclose(thick, reflected([over], count=24, **chosen), atol=1e-12)


def test_far_beyond_a_thousand_optical_depths():
    for depth in (1e1, 1e3, 1e6, 1e12):
        balance = stack_balance([Layer(5, 500, 0.8, depth), Layer(1, 10, 0.5, depth)])
        assert balance.reflected == pytest.approx(reflected([Layer(5, 500, 0.8)]), abs=1e-13)
        assert balance.transmitted == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("absorption", [0.0, 0.5])
def test_hardly_a_layer(depth, absorption):
    """Optical depths down to 1e-7, where both forms of the layer step are 1/t large."""
    layers = [Layer(absorption, 1.0, 0.0, depth)]
    for below in ([], [Layer(1, 100, 0.8)]):
        options = {"dimension": 2, "refractive_index": 1.2, "count": 64}
        fast = stack_balance(layers + below, **options)
        plain = adding_doubling(layers + below, **options)
        assert (fast.reflected, fast.transmitted) == pytest.approx(plain, abs=1e-8)


def test_conservative_slab_falls_off_as_one_over_depth():
    """Without absorption 1 / T is linear in depth once radiance is diffuse."""
    inverse = [1 / stack_balance([Layer(0, 100, 0.5, d)]).transmitted for d in (1.0, 2.0, 3.0)]
    assert inverse[2] - inverse[1] == pytest.approx(inverse[1] - inverse[0], rel=1e-10)


@pytest.mark.parametrize("dimension", [2, 3])
def test_black_dermis(dimension):
    """Over a black dermis light comes from the epidermis only, as if nothing lay below."""
    epidermis = Layer(5, 300, 0.8, 0.01)
    black = reflected([epidermis, Layer(1e12, 300, 0.8)], dimension=dimension)
    assert black == pytest.approx(reflected([epidermis], dimension=dimension), abs=1e-5)
    assert reflected([Layer(1e12, 300, 0.8)], dimension=dimension) < 1e-8


def test_brighter_with_less_absorption():
    albedo = two_layer_albedo([0.5, 5, 50], [0.5, 5, 50], [20.0, 200.0], 200, 0.8)
    assert np.all(np.diff(albedo, axis=0) < 0)
    assert np.all(np.diff(albedo, axis=1) < 0)


def test_similarity():
    """Bright media that share μs′ = μs (1 − g) look nearly alike; flatland outshines space."""
    for dimension in (2, 3):
        forward = reflected([Layer(0.1, 100, 0.9)], dimension=dimension)
        isotropic = reflected([Layer(0.1, 10, 0.0)], dimension=dimension)
        assert forward == pytest.approx(isotropic, abs=0.01)
        assert forward != pytest.approx(isotropic, abs=1e-6)
    assert reflected([Layer(1, 100, 0.8)], dimension=2) > reflected([Layer(1, 100, 0.8)])


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
def test_converges_spectrally(dimension, index):
    """Error against 64 nodes falls from count to count and below the numbers of the docs page."""
    counts, bounds = (8, 12, 16, 24, 32, 48), (1e-2, 2e-3, 5e-4, 3e-5, 2e-6, 1e-8)
    worst = np.zeros(len(counts))
    for band in (0, 20, 40):
        mus, g = (
            float(x[band])
            for x in (ALIAGA2022.scattering(WAVELENGTHS), ALIAGA2022.anisotropy(WAVELENGTHS))
        )
        skins = ([0.5, 20.0, 800.0], [0.5, 20.0], [10.0, 250.0], mus, g)
        chosen = {"dimension": dimension, "refractive_index": index}
        exact = two_layer_albedo(*skins, count=64, **chosen)
        errors = [np.abs(two_layer_albedo(*skins, count=c, **chosen) - exact).max() for c in counts]
        worst = np.maximum(worst, errors)
    assert np.all(np.diff(worst) < 0), worst
    assert np.all(worst < bounds), worst


@pytest.mark.parametrize(("dimension", "index"), PROBLEMS)
@pytest.mark.parametrize("incidence", ["lambertian", 1.0])
def test_two_layers_are_a_stack(dimension, index, incidence):
    chosen = {"dimension": dimension, "refractive_index": index, "incidence": incidence}
    epidermis, dermis, microns = [0.0, 3.0, 900.0], [0.0, 2.0], [10.0, 80.0, 250.0]
    batch = two_layer_albedo(epidermis, dermis, microns, 250.0, 0.78, count=20, **chosen)
    assert batch.shape == (3, 2, 3)
    for i, e in enumerate(epidermis):
        for j, d in enumerate(dermis):
            for k, t in enumerate(microns):
                layers = [Layer(e, 250, 0.78, t * 1e-4), Layer(d, 250, 0.78)]
                one = reflected(layers, count=20, **chosen)
                assert batch[i, j, k] == pytest.approx(one, abs=1e-11)


def test_scalars_are_lists_of_one():
    assert two_layer_albedo(3.0, 2.0, 80.0, 250.0, 0.78).shape == (1, 1, 1)


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        ([], "at least one layer"),
        ([Layer(-1, 10)], "layer 1"),
        ([Layer(1, -10)], "layer 1"),
        ([Layer(np.nan, 10)], "layer 1"),
        ([Layer(1, np.inf)], "layer 1"),
        ([Layer(0, 0)], "both zero"),
        ([Layer(1, 10, 1.0)], "anisotropy"),
        ([Layer(1, 10, -1.0)], "anisotropy"),
        ([Layer(1, 10, np.nan)], "layer 1"),
        ([Layer(1, 10), Layer(1, 10)], "layer 1: depth"),
        ([Layer(1, 10, 0, 1), Layer(1, 10, 0, 0)], "layer 2: depth"),
        ([Layer(1, 10, 0, -1)], "depth"),
        ([Layer(1, 10, 0, np.nan)], "depth"),
    ],
)
@pytest.mark.parametrize("solver", [stack_balance, adding_doubling])
def test_bad_layers_are_one_line(layers, words, solver):
    with pytest.raises(CutisError, match=words) as caught:
        solver(layers)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "wrong", [{"dimension": 1}, {"refractive_index": -1.0}, {"incidence": "sky"}, {"count": 0}]
)
@pytest.mark.parametrize("solver", [stack_balance, adding_doubling])
def test_bad_options_are_one_line(wrong, solver):
    with pytest.raises(CutisError, match=next(iter(wrong))) as caught:
        solver([Layer(1, 10)], **wrong)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"epidermis_absorption": [-1.0]}, "epidermis"),
        ({"dermis_absorption": [np.nan]}, "dermis"),
        ({"dermis_absorption": [[1.0]]}, "dermis"),
        ({"thickness": [0.0]}, "thickness"),
        ({"thickness": [np.inf]}, "thickness"),
        ({"thickness": [np.nan]}, "thickness"),
        ({"scattering": -1.0}, "scattering"),
        ({"scattering": np.nan}, "scattering"),
        ({"scattering": 0.0, "dermis_absorption": [0.0]}, "both be zero"),
        ({"anisotropy": 1.0}, "anisotropy"),
        ({"anisotropy": np.nan}, "anisotropy"),
        ({"dimension": 4}, "dimension"),
        ({"incidence": 0.0}, "incidence"),
    ],
)
def test_bad_skins_are_one_line(change, word):
    good = {
        "epidermis_absorption": [1.0],
        "dermis_absorption": [1.0],
        "thickness": [80.0],
        "scattering": 200.0,
        "anisotropy": 0.8,
    }
    with pytest.raises(CutisError, match=word) as caught:
        two_layer_albedo(**{**good, **change})
    assert "\n" not in str(caught.value)
