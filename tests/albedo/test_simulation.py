"""Simulated skins: the solver within their errors, the same bits however they are cut up."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, norm

import cutis.albedo.simulation as simulation
from cutis.albedo import SkinSimulation, TensorSimulation, Walks, albedo_space, grid_skins, uniform
from cutis.errors import CutisError
from cutis.optics import ALIAGA2022, GITLINA2020, PARAMETERS, to_coordinates

LEVEL = 1e-3
SKINS = uniform(5, seed=3)


def whole(one):
    return one.assemble([one.compute(batch) for batch in range(one.batches)])


def test_skins_against_the_solver():
    """205 albedos with their own errors: the largest (Bonferroni) and all together (χ²)."""
    mean, error = whole(SkinSimulation(SKINS, Walks(ALIAGA2022, photons=4000, seed=12)))
    z = (mean - albedo_space(ALIAGA2022).reflectance(SKINS)) / error
    assert mean.shape == error.shape == (5, 41)
    assert np.abs(z).max() < norm.isf(LEVEL / (2 * z.size))
    assert chi2.isf(1 - LEVEL, z.size) < np.sum(z**2) < chi2.isf(LEVEL, z.size)


def test_batches_do_not_change_a_bit(monkeypatch):
    one = whole(SkinSimulation(SKINS, Walks(ALIAGA2022, photons=500)))
    monkeypatch.setattr(simulation, "BATCH_PHOTONS", 2 * 500 * 41)
    cut = SkinSimulation(SKINS, Walks(ALIAGA2022, photons=500))
    assert (cut.size, cut.batches) == (2, 3)
    for a, b in zip(one, whole(cut), strict=True):
        assert np.array_equal(a, b)
    backwards = {batch: cut.compute(batch) for batch in (2, 0, 1)}
    again = cut.assemble([backwards[batch] for batch in range(3)])
    assert np.array_equal(again[0], one[0])


def test_seeds_differ():
    first, second = (
        whole(SkinSimulation(SKINS[:1], Walks(ALIAGA2022, photons=300, seed=s))) for s in (0, 1)
    )
    assert not np.array_equal(first[0], second[0])


def test_a_tensor_against_the_solver():
    """One number per band and thickness is independent: the mean of z over the absorptions."""
    tensor = TensorSimulation((6, 4, 3, 2, 2), Walks(ALIAGA2022, photons=4000, seed=2))
    assert tensor.batches == 41
    mean, error = whole(tensor)
    assert mean.shape == error.shape == (6 * 4 * 3 * 2 * 2, 41)
    exact = albedo_space(ALIAGA2022).reflectance(tensor.skins)
    z = (mean - exact) / error
    alike = z.reshape(6, 4, 3, 2, 2, 41).mean(axis=(0, 1, 3, 4))  # (thickness, band)
    assert np.abs(alike).max() < norm.isf(LEVEL / (2 * alike.size))
    assert np.abs(z).max() < 6
    # far closer to each other than each is to the truth
    assert np.std(z - z.mean(axis=0)) < np.std(z) + 0.2


def test_nodes_of_a_grid():
    skins = grid_skins((3, 2, 1, 2, 2))
    assert skins.shape == (24, 5)
    u = to_coordinates(skins).reshape(3, 2, 1, 2, 2, 5)
    np.testing.assert_allclose(u[:, 0, 0, 0, 0, 0], [0, 0.5, 1], atol=1e-12)
    np.testing.assert_allclose(u[0, 0, 0, 0, :, 4], [0, 1], atol=1e-12)
    assert np.allclose(u[..., 2], 0.5)
    assert np.allclose(skins[:, 0].max(), PARAMETERS[0].high)


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: Walks(ALIAGA2022, photons=0), "photons = 0"),
        (lambda: Walks(GITLINA2020), "five free parameters"),
        (lambda: SkinSimulation(np.zeros((2, 4)), Walks(ALIAGA2022)), r"\(n, 5\)"),
        (lambda: SkinSimulation(np.zeros((0, 5)), Walks(ALIAGA2022)), r"\(n, 5\)"),
        (lambda: SkinSimulation(np.zeros((1, 5)), Walks(ALIAGA2022)), "melanin"),
        (lambda: SkinSimulation(np.full((1, 5), np.nan), Walks(ALIAGA2022)), "melanin"),
        (lambda: TensorSimulation((4, 4, 0, 1, 1), Walks(ALIAGA2022)), "above zero"),
        (
            lambda: TensorSimulation(
                (2, 2, 1, 1, 1),
                Walks(replace(ALIAGA2022, boundary="fresnel")),
            ),
            "matched",
        ),
    ],
)
def test_bad_input_is_one_line(make, what):
    with pytest.raises(CutisError, match=what) as caught:
        make()
    assert "\n" not in str(caught.value)
