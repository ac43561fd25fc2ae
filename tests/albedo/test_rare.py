"""Albedo with rare chromophores: against the solver, and which way each colour goes."""

from importlib import resources

import numpy as np
import pytest

from cutis.albedo import albedo_space
from cutis.albedo.rare import rare_ratio
from cutis.albedo.sampled import SampledSpace
from cutis.albedo.spectral_table import load, table_file
from cutis.colour.difference import lab
from cutis.optics import (
    ALIAGA2022,
    MEASURED2026,
    PARAMETERS,
    RARE,
    WAVELENGTHS,
    skin,
    with_rare_chromophores,
)
from cutis.transport import two_layer_albedo

ALL = (*PARAMETERS, *RARE)
BOTH = pytest.mark.parametrize("tissue", [ALIAGA2022, MEASURED2026])


def drawn(count, seed=3):
    """(count, 8) skins, even in coordinates over the whole range."""
    u = np.random.default_rng(seed).random((count, len(ALL)))
    return np.stack([p.from_coordinate(u[:, i]) for i, p in enumerate(ALL)], axis=-1)


def spectrum(space, **some):
    return space.reflectance(skin(some, ALL))


@BOTH
def test_the_table_against_the_solver(tissue):
    """Twenty skins of the whole range, ends of the rare ones included, at every band."""
    skins = drawn(20)
    skins[:4, 5:] = np.array([[p.high for p in RARE], [0.2, 0, 0], [0, 0.05, 0], [0, 0, 0.7]])
    got = albedo_space(with_rare_chromophores(tissue)).reflectance(skins)
    for x, found in zip(skins, got, strict=True):
        epidermis = tissue.epidermis_absorption(x[0], x[3], WAVELENGTHS, x[6])
        dermis = tissue.dermis_absorption(x[1], x[4], WAVELENGTHS, *x[5:])
        exact = [
            two_layer_albedo(
                [epidermis[i]],
                [dermis[i]],
                [x[2]],
                float(tissue.scattering(lam)),
                float(tissue.anisotropy(lam)),
                dimension=tissue.dimension,
                refractive_index=tissue.outer_index,
                dermis_scattering=float(tissue.scattering(lam)) * tissue.dermis_scattering,
            ).item()
            for i, lam in enumerate(WAVELENGTHS)
        ]
        np.testing.assert_allclose(found, exact, atol=1e-4)


@BOTH
def test_it_ships_and_is_of_this_tissue(tissue):
    """Else it is built when it is first needed: run studies/build_albedo_table.py."""
    rare = with_rare_chromophores(tissue)
    file = resources.files("cutis.data").joinpath("albedo", table_file(rare))
    with file.open("rb") as stored:
        assert load(stored).tissue == rare
    assert len(file.read_bytes()) < 800_000


@BOTH
def test_without_them_the_skin_is_that_of_the_tissue(tissue):
    skins = drawn(500)
    skins[:, 5:] = 0
    rare = albedo_space(with_rare_chromophores(tissue))
    plain = albedo_space(tissue).reflectance(skins[:, :5])
    np.testing.assert_allclose(rare.reflectance(skins), plain, atol=1e-4)
    assert np.all(rare_ratio(tissue, skins.astype(np.float32)) == 1)


@BOTH
def test_slopes(tissue):
    space = albedo_space(with_rare_chromophores(tissue))
    u = np.random.default_rng(5).uniform(0.2, 0.7, (40, 8))
    skins = np.stack([p.from_coordinate(u[:, i]) for i, p in enumerate(ALL)], axis=-1)
    sampled = SampledSpace(space, np.arange(400.0, 700.0, 13.0))
    spectra, slopes = sampled.gradient(skins)
    colours, colour_slopes = space.rgb_gradient(skins)
    np.testing.assert_allclose(colours, space.rgb(skins), atol=2e-6)
    for i, p in enumerate(ALL):
        step = 2e-3 * (p.high - p.low) * (0.05 if i < 2 else 1)
        up, down = skins.copy(), skins.copy()
        up[:, i] += step
        down[:, i] -= step
        width = (up[:, i] - down[:, i])[:, None]
        rise = (sampled.reflectance(up) - sampled.reflectance(down)) / width
        scale = np.abs(slopes[..., i]).max()
        np.testing.assert_allclose(slopes[..., i], rise, atol=0.02 * scale)
        rise = (space.rgb(up) - space.rgb(down)) / width
        scale = np.abs(colour_slopes[..., i]).max()
        np.testing.assert_allclose(colour_slopes[..., i], rise, atol=0.02 * scale)
    assert spectra.shape == (40, 24)


def lab_of(space, **some):
    return lab(space.rgb(skin(some, ALL))[None])[0]


@BOTH
def test_which_way_they_go(tissue):
    space = albedo_space(with_rare_chromophores(tissue))
    plain = spectrum(space)
    at = {lam: i for i, lam in enumerate(WAVELENGTHS)}
    yellow = spectrum(space, bilirubin=0.04)
    assert lab_of(space, bilirubin=0.04)[2] > lab_of(space)[2] + 5  # b*
    assert np.array_equal(yellow[at[560.0] :], plain[at[560.0] :])
    orange = spectrum(space, carotene=0.015)
    assert np.all(orange[at[450.0] : at[490.0] + 1] < plain[at[450.0] : at[490.0] + 1] - 0.01)
    assert np.array_equal(orange[at[570.0] :], plain[at[570.0] :])
    brown = spectrum(space, methaemoglobin=0.3)
    assert brown[at[630.0]] < 0.95 * plain[at[630.0]]
    assert lab_of(space, methaemoglobin=0.3)[1] < lab_of(space)[1] - 1  # a*: less red
