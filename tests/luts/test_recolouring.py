"""An edit as a function of colour, against estimate, apply and albedo."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.colour import is_skin_colour
from cutis.errors import CutisError
from cutis.looks import presets
from cutis.luts.recolouring import NONE, WHOLE, fading, recolouring, title
from cutis.maps import estimate
from cutis.optics import ALIAGA2022


@pytest.fixture(scope="module")
def skins():
    rgb = albedo_space(ALIAGA2022).rgb(halton(4000, 3))
    return rgb[is_skin_colour(rgb)]


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"white": (0.8, 0.95, 1.1)},
        {"white": (0.8, 0.95, 1.1), "illuminant": "A"},
        {"model": "aliaga2022"},
    ],
)
def test_skins_get_the_edit(how, skins):
    maps = estimate(skins[None], **how)
    edit = recolouring(presets.tanning, maps.model, maps.calibration, 0.7)
    near = np.abs(maps.model_albedo[0] / skins - 1).max(axis=1) < 0.02
    assert near.mean() > 0.3
    wanted = maps.apply(presets.tanning, amount=0.7).albedo()[0]
    np.testing.assert_allclose(edit(skins)[near], wanted[near], rtol=1e-5)


def test_other_colours_stay(skins):
    far = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0.2, 0.6, 0.9]], np.float32)
    assert np.array_equal(recolouring(presets.melanin_fivefold)(far), far)
    assert np.array_equal(recolouring(())(skins), skins)
    assert np.array_equal(recolouring(presets.tanning, amount=0.0)(skins), skins)


def test_no_jump_from_skin_to_blue():
    line = np.linspace(0, 1, 2000)[:, None]
    skin, blue = np.array([0.35, 0.2, 0.14]), np.array([0.1, 0.2, 0.9])
    found = recolouring(presets.melanin_triple)((skin + line * (blue - skin)).astype(np.float32))
    steps = np.abs(np.diff(found, axis=0)).max(axis=1)
    assert steps.max() < 5 * 0.76 / 1999
    assert not np.allclose(found[0], skin, atol=0.01)
    np.testing.assert_allclose(found[-1], blue, atol=1e-6)


def test_fading_is_smooth():
    errors = np.linspace(0, 30, 3001)
    share = fading(errors)
    assert np.all(share[errors <= WHOLE] == 1)
    assert np.all(share[errors >= NONE] == 0)
    assert np.all(np.diff(share) <= 0)
    assert np.abs(np.diff(share, 2)).max() < 1e-5


def test_titles():
    assert title(presets.tanning, 0.5) == (
        "tanning: melanin x1.4, amount 0.5; tanning: eumelanin 0.001, amount 0.5"
    )
    assert title(()) == "no edit"


def test_bad_input():
    with pytest.raises(CutisError, match="places"):
        recolouring(presets.vitiligo)
    with pytest.raises(CutisError, match="0 to 1"):
        recolouring(presets.tanning, amount=1.5)
