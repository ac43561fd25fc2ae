"""Models by name."""

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.inverse import MODELS, load_model
from cutis.optics import PARAMETERS, from_coordinates


@pytest.mark.parametrize("name", MODELS)
def test_parameters_are_in_range_for_any_colour(name):
    colours = [[0, 0, 0], [1, 1, 1], [0, 0, 1], [9, 7, 5], [-0.1, 0.2, 0.1], [0.5, 0.3, 0.2]]
    skins = load_model(name).encode(colours)
    assert skins.shape == (6, 5)
    for i, known in enumerate(PARAMETERS):
        assert np.all(skins[:, i] >= np.float32(known.low))
        assert np.all(skins[:, i] <= np.float32(known.high))


@pytest.mark.parametrize("name", [name for name in MODELS if name != "kubelka-munk"])
def test_loop_closes_on_skins(name):
    """Of the baseline, whose colours are a surface that skins leave: test_kubelka_munk.py."""
    u = np.random.default_rng(0).uniform(0.15, 0.6, (2, 100, 5))
    rgb = albedo_space().rgb(from_coordinates(u))
    model = load_model(name)
    assert np.abs(model.decode(model.encode(rgb)) - rgb).mean() < 2e-3


def test_default_decodes_as_the_exact_space_does():
    skins = from_coordinates(np.random.default_rng(1).random((50, 5)))
    np.testing.assert_allclose(load_model().decode(skins), albedo_space().rgb(skins), atol=3e-4)


@pytest.mark.parametrize("name", MODELS)
def test_shapes(name):
    model, grid = load_model(name), np.full((2, 3, 3), (0.5, 0.3, 0.2))
    assert model.encode(grid).shape == (2, 3, 5)
    assert model.decode(model.encode(grid)).shape == (2, 3, 3)
    assert model.encode(grid).dtype == model.decode(model.encode(grid)).dtype == np.float32
    assert model.encode(grid[:0]).shape == (0, 3, 5)


@pytest.mark.parametrize("name", ["nobody", "missing.safetensors", ""])
def test_unknown_names_are_refused(name):
    with pytest.raises(CutisError, match="unknown model"):
        load_model(name)
