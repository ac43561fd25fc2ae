"""The spectral table against the exact solver, over the whole range and at its corners."""

import io
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from cutis.albedo import AlbedoSpace, albedo_space, build, spectral_table
from cutis.albedo.spectral_table import (
    NODES,
    SpectralTable,
    axis_ranges,
    load,
    save,
)
from cutis.optics import ALIAGA2022, PARAMETERS, WAVELENGTHS, Tissue, from_coordinates
from cutis.transport import two_layer_albedo

PROMISED = 1e-4
"""Worst error of the albedo that docs/albedo.md promises; measured 5e-6."""


def exact(tissue: Tissue, band: int, skins: np.ndarray, count: int) -> np.ndarray:
    """Albedo (n, n, n) at one wavelength of all combinations of (n, 5) skins' layers."""
    lam = WAVELENGTHS[band : band + 1]
    return two_layer_albedo(
        tissue.epidermis_absorption(skins[:, 0], skins[:, 3], lam)[:, 0],
        tissue.dermis_absorption(skins[:, 1], skins[:, 4], lam)[:, 0],
        skins[:, 2],
        float(tissue.scattering(lam)[0]),
        float(tissue.anisotropy(lam)[0]),
        dimension=tissue.dimension,
        refractive_index=tissue.refractive_index if tissue.boundary == "fresnel" else 1.0,
        count=count,
    )


def combinations(skins: np.ndarray) -> np.ndarray:
    """(n, n, n, 5): epidermis of the first, dermis of the second, thickness of the third skin."""
    e, d, t = np.meshgrid(*[np.arange(len(skins))] * 3, indexing="ij")
    columns = (skins[e, 0], skins[d, 1], skins[t, 2], skins[e, 3], skins[d, 4])
    return np.stack(columns, axis=-1)


def worst_errors(space: AlbedoSpace, blocks: int, size: int, bands=range(41), seed=0, count=32):
    """(bands,) worst error over `blocks` random outer products; half of each reaches an end."""
    rng = np.random.default_rng(seed)
    worst = []
    for band in bands:
        errors = []
        for _ in range(blocks):
            u = rng.random((size, 5))
            u[0] = u[0].round()
            u[1, rng.integers(0, 5)] = rng.integers(0, 2)
            skins = from_coordinates(u)
            got = space.reflectance(combinations(skins))[..., band]
            errors.append(np.abs(got - exact(space.tissue, band, skins, count)).max())
        worst.append(max(errors))
    return np.array(worst)


def test_twenty_thousand_skins():
    """41 wavelengths × 3 blocks × 6³ = 26 568 albedos; 32 directions are exact to 1e-7."""
    worst = worst_errors(albedo_space(ALIAGA2022), blocks=3, size=6)
    assert worst.max() < PROMISED
    assert worst.max() < 1e-5, "not what docs/albedo.md says any more"


def test_against_more_directions():
    """The same for 41 × 4³ albedos and 48 directions (studies/albedo_accuracy.py does 53 136)."""
    assert worst_errors(albedo_space(ALIAGA2022), blocks=1, size=4, seed=1, count=48).max() < 1e-5


def test_every_corner_at_every_wavelength():
    corners = np.array(list(product(*((p.low, p.high) for p in PARAMETERS))))
    got = albedo_space(ALIAGA2022).reflectance(corners)
    tissue = ALIAGA2022
    for band, lam in enumerate(WAVELENGTHS):
        epidermis = tissue.epidermis_absorption(corners[:, 0], corners[:, 3], lam)[:, 0]
        dermis = tissue.dermis_absorption(corners[:, 1], corners[:, 4], lam)[:, 0]
        e, e_index = np.unique(epidermis, return_inverse=True)
        d, d_index = np.unique(dermis, return_inverse=True)
        t, t_index = np.unique(corners[:, 2], return_inverse=True)
        scattering, g = float(tissue.scattering(lam)), float(tissue.anisotropy(lam))
        albedo = two_layer_albedo(e, d, t, scattering, g, count=40)
        expected = albedo[e_index, d_index, t_index]
        np.testing.assert_allclose(got[:, band], expected, atol=2e-5)


def test_shipped_table_is_what_build_makes():
    """At five wavelengths, to the float32 that it is stored in."""
    shipped = spectral_table(ALIAGA2022)
    low, high = axis_ranges(ALIAGA2022)
    for band in (0, 9, 17, 26, 40):
        axes = []
        for axis, count in enumerate(NODES):
            x = (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
            axes.append(low[band, axis] + x * (high[band, axis] - low[band, axis]))
        rebuilt = two_layer_albedo(
            axes[0] ** 4,
            axes[1] ** 4,
            np.exp(axes[2]),
            float(ALIAGA2022.scattering(WAVELENGTHS)[band]),
            float(ALIAGA2022.anisotropy(WAVELENGTHS)[band]),
            count=24,
        )
        np.testing.assert_allclose(shipped.nodes[band], rebuilt, atol=2e-7)
    assert shipped.tissue == ALIAGA2022
    assert spectral_table(ALIAGA2022) is shipped


def test_save_and_load():
    table = spectral_table(ALIAGA2022)
    file = io.BytesIO()
    save(table, file)
    file.seek(0)
    again = load(file)
    assert again.tissue == table.tissue
    np.testing.assert_array_equal(again.coefficients, table.coefficients)
    np.testing.assert_array_equal(again.low, table.low)
    np.testing.assert_array_equal(again.high, table.high)
    assert again.coefficients.dtype == np.float32
    assert again.coefficients.shape == (41, 27, 27, 19)


@pytest.fixture(scope="module")
def physical() -> tuple[SpectralTable, list[tuple[int, int]]]:
    """A variant in space with a Fresnel boundary, and the progress that its making reported."""
    calls: list[tuple[int, int]] = []
    tissue = replace(ALIAGA2022, name="physical", dimension=3, boundary="fresnel")
    return build(tissue, lambda done, total: calls.append((done, total))), calls


@pytest.mark.slow
def test_a_variant_in_space_with_a_surface(physical):
    table, calls = physical
    assert calls == [(i + 1, 41) for i in range(41)]
    space = AlbedoSpace(table)
    worst = worst_errors(space, blocks=1, size=4, bands=range(0, 41, 8))
    assert worst.max() < 5e-5
    skin = np.array([0.02, 0.02, 80.0, 0.7, 0.7])
    assert np.all(space.reflectance(skin) < albedo_space(ALIAGA2022).reflectance(skin))


@pytest.mark.slow
def test_a_variant_keeps_its_constants(physical, tmp_path):
    table, _ = physical
    file = tmp_path / "physical.npz"
    save(table, str(file))
    assert load(str(file)).tissue == table.tissue


def test_ranges_cover_every_skin():
    low, high = axis_ranges(ALIAGA2022)
    skins = from_coordinates(np.random.default_rng(2).random((500, 5)))
    epidermis = ALIAGA2022.epidermis_absorption(skins[:, 0], skins[:, 3], WAVELENGTHS) ** 0.25
    dermis = ALIAGA2022.dermis_absorption(skins[:, 1], skins[:, 4], WAVELENGTHS) ** 0.25
    assert np.all((epidermis >= low[:, 0]) & (epidermis <= high[:, 0]))
    assert np.all((dermis >= low[:, 1]) & (dermis <= high[:, 1]))
