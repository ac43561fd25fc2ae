"""Directions: they integrate what they should, and refuse what they cannot be made of."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.transport.quadrature import BEAM_WEIGHT, beam_cosine, directions


@pytest.mark.parametrize("index", [1.0, 1.4])
@pytest.mark.parametrize(("dimension", "mean"), [(2, 2 / np.pi), (3, 0.5)])
def test_integrates_the_hemisphere(dimension, mean, index):
    nodes = directions(32, dimension, index)
    assert len(nodes.cosine) == 32
    assert nodes.weight.sum() == pytest.approx(1, abs=1e-14)
    assert nodes.weight @ nodes.cosine == pytest.approx(mean, abs=1e-9)
    assert np.all(nodes.weight > 0)
    np.testing.assert_allclose(nodes.sine**2 + nodes.cosine**2, 1, atol=1e-14)
    np.testing.assert_allclose(nodes.flux**2, nodes.weight * nodes.cosine, rtol=1e-14)


def test_nodes_keep_off_the_critical_angle():
    """Half the nodes can escape, half are totally reflected."""
    nodes = directions(24, 2, 1.4)
    assert np.sum(nodes.sine < 1 / 1.4) == 12


def test_odd_counts():
    assert len(directions(25, 3, 1.4).cosine) == 25


def test_beam_is_one_more_node():
    nodes = directions(8, 3, 1.0, beam=0.3)
    assert nodes.cosine[-1] == 0.3
    assert nodes.weight[-1] == BEAM_WEIGHT


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ((24, 1), "dimension"),
        ((24, 4), "dimension"),
        ((1, 2), "count"),
        ((24, 2, 0.0), "refractive_index"),
        ((24, 2, np.nan), "refractive_index"),
    ],
)
def test_bad_input_is_one_line(arguments, word):
    with pytest.raises(CutisError, match=word) as caught:
        directions(*arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("incidence", [0.0, -0.5, 1.1, np.nan, "diffuse"])
def test_bad_incidence_is_one_line(incidence):
    with pytest.raises(CutisError, match="incidence") as caught:
        beam_cosine(incidence)
    assert "\n" not in str(caught.value)


def test_good_incidence():
    assert beam_cosine("lambertian") is None
    assert beam_cosine(1) == 1.0
