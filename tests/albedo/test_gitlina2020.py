"""The albedo space of a tissue with other parameters, and its inverse, against the solver."""

from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo import AlbedoSpace, albedo_space
from cutis.albedo.spectral_table import load, save
from cutis.colour import delta_e, spectrum_to_rgb
from cutis.inverse import fit
from cutis.optics import ALIAGA2022, GITLINA2020, WAVELENGTHS
from cutis.transport import Layer, adding_doubling, stack_balance, two_layer_albedo


@pytest.fixture(scope="module")
def space():
    return albedo_space(GITLINA2020)


@pytest.fixture(scope="module")
def skins():
    u = np.random.default_rng(6).random((300, 4))
    return np.stack(
        [p.from_coordinate(u[:, i]) for i, p in enumerate(GITLINA2020.parameters)], axis=-1
    )


def exact(skin):
    """(41,) albedo from the solver, the epidermis' absorption written out."""
    melanin, blood, eumelanin, epidermal = skin
    tissue, lam = GITLINA2020, WAVELENGTHS
    deoxygenated, oxygenated = tissue.whole_blood(lam)
    whole = 0.75 * oxygenated + 0.25 * deoxygenated
    pigment = eumelanin * tissue.eumelanin(lam) + (1 - eumelanin) * tissue.pheomelanin(lam)
    background = tissue.baseline(lam)
    epidermis = melanin * pigment + epidermal * whole + (1 - melanin - epidermal) * background
    dermis = blood * whole + (1 - blood) * background
    return np.array(
        [
            two_layer_albedo(
                e, d, 250.0, float(s), float(g), dimension=3, refractive_index=1.4, count=32,
                dermis_scattering=float(s) / 2,
            ).item()
            for e, d, s, g in zip(
                epidermis, dermis, tissue.scattering(lam), tissue.anisotropy(lam), strict=True
            )
        ]
    )  # fmt: skip


def test_albedo_is_that_of_the_solver(space, skins):
    for skin in skins[:6]:
        np.testing.assert_allclose(space.reflectance(skin), exact(skin), atol=1e-4)
    np.testing.assert_allclose(
        space.rgb(skins), space.reflectance(skins) @ spectrum_to_rgb(WAVELENGTHS), atol=1e-5
    )


def test_slopes_are_differences(space, skins):
    colour, slope = space.rgb_gradient(skins[:50])
    assert slope.shape == (50, 3, 4)
    np.testing.assert_allclose(colour, space.rgb(skins[:50]), atol=1e-6)
    for axis in range(4):
        step = 0.02 * skins[:50, axis]
        more, less = skins[:50].copy(), skins[:50].copy()
        more[:, axis] += step
        less[:, axis] -= step
        difference = (space.rgb(more) - space.rgb(less)) / 2
        np.testing.assert_allclose(slope[..., axis] * step[:, None], difference, atol=2e-4)


def test_colours_come_back(space, skins):
    colours = space.rgb(skins)
    found = fit(space, colours, np.full(4, 0.5), np.eye(4), 1e-3)
    assert found.shape == (300, 4)
    again = np.stack(
        [p.from_coordinate(found[:, i]) for i, p in enumerate(GITLINA2020.parameters)], axis=-1
    )
    error = delta_e(space.rgb(again), colours)
    assert np.median(error) < 0.05
    assert np.percentile(error, 90) < 0.5


def test_a_fixed_parameter_is_the_same_as_that_parameter():
    """`aliaga2022` with its thickness held is `aliaga2022` at that thickness."""
    held = albedo_space(replace(ALIAGA2022, name="held", fixed=(("thickness", 80.0),)))
    skins = np.array([[0.02, 0.02, 0.7, 0.7], [0.3, 0.1, 0.2, 0.1]])
    whole = np.insert(skins, 2, 80.0, axis=1)
    np.testing.assert_allclose(
        held.reflectance(skins), albedo_space(ALIAGA2022).reflectance(whole), atol=2e-5
    )


def test_layers_that_scatter_differently():
    """`two_layer_albedo` with its own scattering for the dermis against two other solvers."""
    layers = [Layer(12.0, 300.0, 0.8, 0.01), Layer(1.5, 150.0, 0.8)]
    how = {"dimension": 3, "refractive_index": 1.4}
    own = two_layer_albedo(12.0, 1.5, 100.0, 300.0, 0.8, dermis_scattering=150.0, count=32, **how)
    assert own.item() == pytest.approx(stack_balance(layers, count=48, **how).reflected, abs=2e-6)
    thick = [layers[0], replace(layers[1], depth=40.0)]
    assert own.item() == pytest.approx(adding_doubling(thick, **how)[0], abs=1e-4)


def test_its_table_round_trips(space, skins, tmp_path):
    save(space.table, str(tmp_path / "table.npz"))
    again = AlbedoSpace(load(str(tmp_path / "table.npz")))
    assert again.tissue == GITLINA2020
    np.testing.assert_allclose(again.reflectance(skins), space.reflectance(skins), atol=1e-5)
