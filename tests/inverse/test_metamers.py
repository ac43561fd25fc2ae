"""Families of skins behind one colour."""

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.colour import delta_e
from cutis.errors import CutisError
from cutis.inverse.metamers import colours_under, metamers, spread
from cutis.optics import ALIAGA2022, GITLINA2020, from_coordinates, to_coordinates

LIGHT = np.array([0.02, 0.02, 80.0, 0.7, 0.7])


@pytest.fixture(scope="module")
def family():
    return metamers(albedo_space(ALIAGA2022).rgb(LIGHT), count=300, space=albedo_space(ALIAGA2022))


def test_members_have_the_colour(family):
    rgb = albedo_space(ALIAGA2022).rgb(family.skins)
    target = np.broadcast_to(family.colour, rgb.shape)
    assert family.skins.shape == (300, 5)
    assert delta_e(rgb, target).max() < 1.0


def test_the_box_cuts_nothing_off():
    """The same family by plain rejection over the whole albedo space, here with ΔE00 < 4."""
    target = albedo_space(ALIAGA2022).rgb(LIGHT)
    u = np.random.default_rng(1).random((400_000, 5))
    rgb = albedo_space(ALIAGA2022).rgb(from_coordinates(u))
    members = u[delta_e(rgb, np.broadcast_to(target, rgb.shape)) < 4.0]
    found = metamers(target, 4.0, 4000, space=albedo_space(ALIAGA2022), seed=2)
    expected = len(members) / len(u)
    assert abs(found.share / expected - 1) < 4 * np.sqrt(1 / len(members) + 1 / 4000)
    ours = to_coordinates(found.skins)
    shares = [0.01, 0.1, 0.5, 0.9, 0.99]
    gap = np.quantile(ours, shares, axis=0) - np.quantile(members, shares, axis=0)
    assert np.abs(gap).max() < 0.08


def test_other_lights_tell_them_apart(family):
    colours = colours_under(family.skins, ["D65", "A"], albedo_space(ALIAGA2022))
    assert np.allclose(colours["D65"], albedo_space(ALIAGA2022).rgb(family.skins), atol=1e-5)
    assert np.mean(spread(colours["A"])) > 1.5 * np.mean(spread(colours["D65"]))


def test_other_tissues_are_refused():
    with pytest.raises(CutisError, match="five free parameters"):
        metamers([0.5, 0.4, 0.3], space=albedo_space(GITLINA2020))


@pytest.mark.parametrize(
    ("colour", "how", "what"),
    [
        ([0.5, 0.4], {}, "three finite"),
        ([0.5, np.nan, 0.4], {}, "three finite"),
        ([0.0, 1.0, 0.0], {}, "gamut"),
        ([0.5, 0.4, 0.3], {"tolerance": 0.0}, "above zero"),
    ],
)
def test_bad_input_is_one_line(colour, how, what):
    with pytest.raises(CutisError, match=what) as caught:
        metamers(colour, space=albedo_space(ALIAGA2022), **how)
    assert "\n" not in str(caught.value)
