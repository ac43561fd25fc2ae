"""Models by name."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.errors import CutisError
from cutis.inverse import MODELS
from cutis.inverse.baked import Baked, Chart
from cutis.inverse.trust import look_up_trust
from cutis.maps import DEFAULT, load_model
from cutis.maps.defaults import OLD_DEFAULT
from cutis.optics import ALIAGA2022, MEASURED2026, PARAMETERS, from_coordinates


def test_no_sigma_is_wider_than_its_range():
    colours = [[0, 0, 0], [1, 1, 1], [0, 0, 1], [1, 0, 0], [0.02, 0.02, 0.02], [5, 3, 2.5]]
    found = load_model().trust(colours)
    widths = np.array([known.high - known.low for known in PARAMETERS], np.float32)
    assert (found[:, :5] > 0).all()
    assert (found[:, :5] <= widths).all()
    wide = Baked(np.full((5, 5, 5, 6), 6.0, np.float32), Chart((0, 0, 0), (1, 1, 1), (2, 2, 2)))
    np.testing.assert_array_equal(look_up_trust(wide, np.float32(colours))[:, :5], [widths] * 6)


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
    model = load_model(name)
    rgb = albedo_space(model.tissue).rgb(from_coordinates(u))
    assert np.abs(model.decode(model.encode(rgb)) - rgb).mean() < 2e-3


def test_default_decodes_as_the_exact_space_does():
    skins = from_coordinates(np.random.default_rng(1).random((50, 5)))
    exact = albedo_space(load_model().tissue).rgb(skins)
    np.testing.assert_allclose(load_model().decode(skins), exact, atol=3e-4)


def test_default_is_another_name():
    assert load_model() is load_model("default") is load_model(DEFAULT)
    assert "default" not in MODELS


def test_headers_that_say_default_are_from_before():
    assert OLD_DEFAULT == "aliaga2022-exact"


def test_a_model_without_trust_has_none():
    assert load_model("aliaga2022-exact").trust(np.full((2, 3), 0.3)) is None


def test_trust_goes_through_in_bands(monkeypatch):
    monkeypatch.setattr("cutis.inverse.model.BAND", 4)
    plain = load_model("aliaga2022-exact")
    knows = replace(plain, to_trust=lambda rgb: np.tile(rgb, 2))
    rgb = np.random.default_rng(3).random((3, 5, 3), dtype=np.float32)
    np.testing.assert_array_equal(knows.trust(rgb), np.tile(rgb, 2))


def test_models_have_their_tissue():
    assert load_model("measured2026").tissue is MEASURED2026
    for name in ("aliaga2022-exact", "aliaga2022", "lookup", "kubelka-munk"):
        assert load_model(name).tissue is load_model(name).tissue is ALIAGA2022


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
