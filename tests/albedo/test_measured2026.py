"""The table of the calibrated tissue: the one that ships, exact to what docs/albedo.md promises."""

from importlib import resources

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.albedo.spectral_table import load
from cutis.optics import MEASURED2026, WAVELENGTHS
from cutis.transport import two_layer_albedo


def test_the_table_ships():
    """Else every process would solve it anew."""
    folder = resources.files("cutis.data").joinpath("albedo")
    with folder.joinpath("measured2026.npz").open("rb") as file:
        assert load(file).tissue == MEASURED2026


@pytest.mark.parametrize("band", [0, 4, 16, 20, 32, 40])
def test_table_against_the_solver(band):
    skins, lam = halton(40, seed=7), WAVELENGTHS[band]
    found = albedo_space(MEASURED2026).reflectance(skins)[:, band]
    exact = [
        two_layer_albedo(
            MEASURED2026.epidermis_absorption(x[0], x[3], lam),
            MEASURED2026.dermis_absorption(x[1], x[4], lam),
            [x[2]],
            float(MEASURED2026.scattering(lam)),
            float(MEASURED2026.anisotropy(lam)),
            dimension=3,
            refractive_index=1.4,
            count=32,
        )[0, 0, 0]
        for x in skins
    ]
    assert np.abs(found - exact).max() < 1e-4
