"""Eight products per wavelength against the spline of all three axes, summed node by node."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, spectral_table, uniform
from cutis.albedo.separated import TERMS, separate
from cutis.albedo.spectral_table import CELLS
from cutis.kernels.splines import basis
from cutis.optics import ALIAGA2022, GITLINA2020, WAVELENGTHS, Tissue


def coordinates(tissue: Tissue, skins: np.ndarray, band: int) -> list[np.ndarray]:
    table, lam = spectral_table(tissue), WAVELENGTHS[band : band + 1]
    roots = [
        tissue.epidermis_absorption(skins[:, 0], skins[:, 3], lam)[:, 0] ** 0.25,
        tissue.dermis_absorption(skins[:, 1], skins[:, 4], lam)[:, 0] ** 0.25,
        np.log(skins[:, 2]),
    ]
    span = table.high[band] - table.low[band]
    return [(x - low) / s for x, low, s in zip(roots, table.low[band], span, strict=True)]


def test_reflectance_is_the_tensor_product_spline():
    tissue, skins = ALIAGA2022, uniform(400, seed=3)
    space, table = albedo_space(tissue), spectral_table(tissue)
    got = space.reflectance(skins)
    for band in range(0, 41, 5):
        e, d, t = map(basis, coordinates(tissue, skins, band), CELLS)
        expected = np.einsum("ne,nd,nt,edt->n", e, d, t, table.coefficients[band], optimize=True)
        np.testing.assert_allclose(got[:, band], expected, atol=2e-6)


@pytest.mark.parametrize("tissue", [ALIAGA2022, GITLINA2020], ids=lambda t: t.name)
def test_products_multiply_out_to_the_table(tissue):
    """At the nodes' own places inside; coefficients beyond the ends are extrapolations."""
    table = spectral_table(tissue)
    upper, lower = separate(table)
    assert upper.shape == (41, CELLS[0] + 3, CELLS[2] + 3, TERMS)
    assert lower.shape == (41, CELLS[1] + 3, TERMS)
    ends = [basis(np.linspace(0, 1, 2 * cells + 1), cells) for cells in CELLS]
    product = np.einsum("betr,bdr->bedt", upper.astype(float), lower.astype(float))
    error = product - table.coefficients
    values = np.einsum("xe,yd,zt,bedt->bxyz", *ends, error, optimize=True)
    assert np.abs(values).max() < 3e-6


def test_more_texels_than_a_block_and_fewer():
    space, skins = albedo_space(ALIAGA2022), uniform(700, seed=4)
    whole, colours = space.reflectance(skins), space.rgb(skins)
    for part in (slice(0, 1), slice(0, 127), slice(500, 700)):
        np.testing.assert_allclose(space.reflectance(skins[part]), whole[part], atol=1e-7)
        np.testing.assert_allclose(space.rgb(skins[part]), colours[part], atol=1e-7)


def test_skins_that_are_not_numbers_stay_inside_the_table():
    skins = uniform(300, seed=5)
    skins[7] = np.nan
    skins[9] = [np.inf, 1, 1e9, -1, 2]
    good = np.delete(np.arange(300), [7, 9])
    got = albedo_space(ALIAGA2022).reflectance(skins)[good]
    np.testing.assert_array_equal(got, albedo_space(ALIAGA2022).reflectance(skins[good]))
