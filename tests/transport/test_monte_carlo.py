"""The walk: closed forms order by order, its error, its independence of threads, bad input."""

import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.stats import norm

from cutis.errors import CutisError
from cutis.kernels import use_threads
from cutis.kernels.compiling import compiled
from cutis.transport import Layer, stack_balance, two_layer_albedo, walk, walk_absorptions
from cutis.transport.history import make_history
from cutis.transport.monte_carlo import BLOCK, walk_stacks

LEVEL = 1e-3
"""Chance that a right walk fails a test, were its seed not fixed."""
SKIN = [Layer(20.0, 160.0, 0.77, 0.008), Layer(1.0, 160.0, 0.77)]

_history = make_history(compiled())


@compiled()
def _orders(photons, stack, dimension, incidence, counts):
    """How many photons leave a half space after 1, 2, … collisions; each costs a thousandth."""
    score = np.zeros(4)
    for photon in range(photons):
        score[:] = 0.0
        _history(
            np.uint64(photon), np.uint64(3), np.uint64(11), stack, dimension, 1.0, incidence, score
        )
        if score[0] > 0.7:  # has not played roulette
            order = round(np.log(score[0]) / np.log(0.999))
            if order <= len(counts):
                counts[order - 1] += 1


@pytest.mark.parametrize(
    ("dimension", "incidence", "expected"),
    [
        (2, 1.0, [(np.pi - 2) / (2 * np.pi), (np.pi - 1) / (2 * np.pi**2)]),
        (2, 0.5, [0.257974]),
        (2, 0.25, [0.330412]),
        (3, 1.0, [(1 - np.log(2)) / 2]),
    ],
)
def test_orders_of_isotropic_scattering(dimension, incidence, expected):
    """Shares that leave after one and two collisions [deon2018flatland], closed forms."""
    photons = 300_000
    counts = np.zeros(2)
    _orders(photons, np.array([[np.inf, 0.001, 0.0, 0.0]]), dimension, incidence, counts)
    for count, share in zip(counts, expected, strict=False):
        z = (count / photons - share) / np.sqrt(share * (1 - share) / photons)
        assert abs(z) < norm.isf(LEVEL / 10), (count / photons, share)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("g", [-0.6, 0.0, 0.9])
def test_single_collision_in_a_thin_layer(dimension, g):
    """A layer so thin and dark that one collision is the last: the share scattered backwards."""
    layers = [Layer(900.0, 100.0, g, 1e-5)]
    found = walk(layers, photons=400_000, dimension=dimension, incidence=1.0, seed=5)
    exact = stack_balance(layers, dimension=dimension, incidence=1.0)
    for mean, error, truth in (
        (found.reflected, found.reflected_error, exact.reflected),
        (found.transmitted, found.transmitted_error, exact.transmitted),
        (found.absorbed[0], found.absorbed_error[0], exact.absorbed[0]),
    ):
        assert abs(mean - truth) < norm.isf(LEVEL / 36) * error


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("index", [1.0, 1.4])
@pytest.mark.parametrize("incidence", ["lambertian", 1.0, 0.3])
def test_every_share_of_a_finite_stack(dimension, index, incidence):
    """Reflected, transmitted and absorbed in each of three layers against the exact solver."""
    layers = [
        Layer(5.0, 150.0, 0.8, 0.01), Layer(0.5, 200.0, 0.0, 0.02), Layer(2.0, 90.0, -0.4, 0.03)
    ]  # fmt: skip
    how = {"dimension": dimension, "refractive_index": index, "incidence": incidence}
    found = walk(layers, photons=60_000, seed=9, **how)
    exact = stack_balance(layers, **how)
    z = np.array(
        [
            (found.reflected - exact.reflected) / found.reflected_error,
            (found.transmitted - exact.transmitted) / found.transmitted_error,
            *((found.absorbed - exact.absorbed) / found.absorbed_error),
        ]
    )
    assert np.abs(z).max() < norm.isf(LEVEL / (2 * 5 * 12)), z
    total = found.reflected + found.transmitted + found.absorbed.sum()
    assert abs(total - 1) < 4 * np.sqrt(np.sum(found.absorbed_error**2))  # roulette alone


def test_error_is_that_of_repeated_walks():
    """The spread over streams of the mean is the standard error that each reports."""
    found = walk_stacks(
        [[20.0, 1.0]], [[160.0, 160.0]], [[0.77, 0.77]], np.full((200, 2), (0.008, np.inf)),
        photons=2000, seed=4,
    )  # fmt: skip
    ratio = found.reflected.var(ddof=1) / np.mean(found.reflected_error**2)
    assert abs(ratio - 1) < norm.isf(LEVEL / 2) * np.sqrt(2 / 199)


def test_threads_do_not_change_the_answer():
    answers = []
    try:
        for threads in (1, 2, 3):
            use_threads(threads)
            answers.append(walk(SKIN, photons=3 * BLOCK + 17, seed=2))
    finally:
        use_threads(None)
    for one in answers:
        assert one.reflected == answers[0].reflected
        assert one.reflected_error == answers[0].reflected_error
        assert np.array_equal(one.absorbed, answers[0].absorbed)


def test_a_case_alone_gives_what_it_gives_among_others(monkeypatch):
    properties = [[[20.0, 1.0]], [[160.0, 160.0]], [[0.77, 0.77]], np.full((5, 2), (0.01, np.inf))]
    photons = 2 * BLOCK + 5
    together = walk_stacks(*properties, photons=photons, streams=[7, 8, 9, 10, 11])
    alone = walk(
        [Layer(20.0, 160.0, 0.77, 0.01), Layer(1.0, 160.0, 0.77)], photons=photons, stream=9
    )
    assert alone.reflected == together.reflected[2]
    assert alone.absorbed_error.tolist() == together.absorbed_error[2].tolist()
    assert len(set(together.reflected)) == 5
    monkeypatch.setattr("cutis.transport.monte_carlo.CASES", 2)
    monkeypatch.setattr("cutis.transport.monte_carlo.BATCH", 1)
    done = []
    apart = walk_stacks(
        *properties,
        photons=photons,
        streams=[7, 8, 9, 10, 11],
        progress=lambda *at: done.append(at),
    )
    assert np.array_equal(apart.reflected, together.reflected)
    assert done[-1] == (5 * photons, 5 * photons)


def test_seeds_and_streams_differ():
    values = {float(walk(SKIN, photons=500, seed=s, stream=t).reflected)
              for s in (0, 1, 1 << 40) for t in (0, 1, 1 << 40)}  # fmt: skip
    assert len(values) == 9


@pytest.mark.parametrize("dimension", [2, 3])
def test_many_absorptions_from_one_set_of_paths(dimension):
    epidermis, dermis = np.array([3.0, 40.0, 1.0]), np.array([0.4, 30.0])
    mean, error = walk_absorptions(
        epidermis, dermis, 90.0, 170.0, 0.75, photons=100_000, seed=3, dimension=dimension
    )
    exact = two_layer_albedo(epidermis, dermis, 90.0, 170.0, 0.75, dimension=dimension)[..., 0]
    z = (mean - exact) / error
    assert np.abs(z).max() < norm.isf(LEVEL / 12), z
    assert error.max() < 1.5e-3


def test_the_reference_absorption_alone_is_the_walk_itself():
    """With one absorption each, the paths carry no extra weight: the same photons, bit for bit."""
    layers = [Layer(3.0, 170.0, 0.75, 90e-4), Layer(0.4, 170.0, 0.75)]
    own = walk(layers, photons=5000, seed=1, stream=2)
    mean, error = walk_absorptions(3.0, 0.4, 90.0, 170.0, 0.75, photons=5000, seed=1, stream=2)
    assert mean[0, 0] == own.reflected
    assert error[0, 0] == own.reflected_error


def test_the_same_history_on_cuda():
    """In Numba's simulator of CUDA, on machines without a device: the kernel, photon by photon."""
    code = """
import numpy as np
from cutis.transport import Layer, walk
layers = [Layer(20.0, 160.0, 0.77, 0.008), Layer(5.0, 160.0, 0.77)]
for dimension, index in ((2, 1.0), (3, 1.4)):
    cpu, cuda = (
        walk(layers, photons=70, dimension=dimension, refractive_index=index, device=device)
        for device in ("cpu", "cuda")
    )
    for name in ("reflected", "reflected_error", "absorbed", "absorbed_error"):
        assert np.allclose(getattr(cpu, name), getattr(cuda, name), rtol=1e-12, atol=0), name
"""
    subprocess.run(
        [sys.executable, "-c", code], check=True, env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
    )


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"photons": 0}, "photons = 0"),
        ({"photons": 1.5}, "photons"),
        ({"photons": 2**33}, "photons"),
        ({"seed": -1}, "seed"),
        ({"dimension": 4}, "dimension"),
        ({"refractive_index": 0.5}, "refractive_index"),
        ({"incidence": 0.0}, "incidence"),
        ({"device": "tpu"}, "device"),
        ({"layers": [Layer(-1.0, 10.0, 0.0, 1.0)]}, "negative"),
        ({"layers": [Layer(1.0, -10.0, 0.0, 1.0)]}, "negative"),
        ({"layers": [Layer(np.nan, 10.0, 0.0, 1.0)]}, "finite"),
        ({"layers": [Layer(0.0, 0.0, 0.0, 1.0)]}, "both be zero"),
        ({"layers": [Layer(1.0, 1.0, 1.0, 1.0)]}, "anisotropy"),
        ({"layers": [Layer(1.0, 1.0, np.nan, 1.0)]}, "anisotropy"),
        ({"layers": [Layer(1.0, 1.0, 0.0, 0.0)]}, "depths"),
        ({"layers": [Layer(1.0, 1.0), Layer(1.0, 1.0)]}, "depths"),
        ({"layers": [Layer(0.0, 1.0)]}, "for ever"),
        ({"layers": []}, "at least one"),
    ],
)
def test_bad_input_is_one_line(change, what):
    with pytest.raises(CutisError, match=what) as caught:
        walk(**{"layers": SKIN, "photons": 10, **change})
    assert "\n" not in str(caught.value)


def test_misfit_arrays_are_one_line():
    with pytest.raises(CutisError, match="fit together"):
        walk_stacks(np.ones((2, 3)), np.ones((2, 2)), 0.0, 1.0)
    with pytest.raises(CutisError, match="streams"):
        walk_stacks(np.ones((2, 1)), 1.0, 0.0, 1.0, streams=[1])
    with pytest.raises(CutisError, match="lists"):
        walk_absorptions([], [1.0], 80.0, 100.0, 0.8)
    with pytest.raises(CutisError, match="negative"):
        walk_absorptions([-1.0], [1.0], 80.0, 100.0, 0.8)
    with pytest.raises(CutisError, match="no CUDA"):
        walk(SKIN, photons=1, device="cuda")


def test_a_single_photon_knows_no_error():
    assert walk(SKIN, photons=1).reflected_error == np.inf


def test_layers_that_do_not_scatter_absorb_by_beer_lambert():
    found = walk([Layer(10.0, 0.0, 0.0, 0.1)], photons=50_000, incidence=1.0)
    assert abs(found.transmitted - np.exp(-1)) < norm.isf(LEVEL / 2) * found.transmitted_error
    assert found.reflected == 0
