"""The tables of the tissue whose dermis scatters by melanin type, against the exact solver."""

from importlib import resources

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.albedo.colour_table import colour_table
from cutis.albedo.spectral_table import load
from cutis.colour import delta_e
from cutis.optics import MEASURED2026B, WAVELENGTHS
from cutis.transport import two_layer_albedo


def test_the_table_ships():
    """Else every process would solve it anew."""
    folder = resources.files("cutis.data").joinpath("albedo")
    with folder.joinpath("measured2026b.npz").open("rb") as file:
        assert load(file).tissue == MEASURED2026B


@pytest.mark.parametrize("band", [0, 4, 16, 20, 32, 40])
def test_table_against_the_solver_with_two_scatterings(band):
    """The table scales absorption of the dermis; the solver is told how each layer scatters."""
    skins, lam = halton(40, seed=7), WAVELENGTHS[band]
    found = albedo_space(MEASURED2026B).reflectance(skins)[:, band]
    exact = [
        two_layer_albedo(
            MEASURED2026B.epidermis_absorption(x[0], x[3], lam),
            MEASURED2026B.dermis_absorption(x[1], x[4], lam),
            [x[2]],
            float(MEASURED2026B.scattering(lam)),
            float(MEASURED2026B.anisotropy(lam)),
            dimension=3,
            refractive_index=1.4,
            count=32,
            dermis_scattering=float(MEASURED2026B.scattering_below(lam, x[3])),
        )[0, 0, 0]
        for x in skins
    ]
    assert np.abs(found - exact).max() < 1e-4


def test_the_colour_table_is_the_albedo_space_to_what_nobody_sees():
    skins = halton(4000, seed=3)
    wrong = delta_e(colour_table(MEASURED2026B).rgb(skins), albedo_space(MEASURED2026B).rgb(skins))
    assert wrong.mean() < 0.01
    assert np.percentile(wrong, 99) < 0.05


def test_the_decoder_is_sixteen_products_in_four_megabytes():
    table = colour_table(MEASURED2026B)
    assert table.upper.shape[-1] == table.lower.shape[-1] == 16
    assert table.upper.nbytes + table.lower.nbytes <= 4 << 20
