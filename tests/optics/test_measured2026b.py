"""The tissue whose dermis scatters by melanin type: its constants, and how it mixes."""

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.kernels.mixture import absorption
from cutis.optics import (
    MEASURED2026B,
    NAMES,
    WAVELENGTHS,
    Tissue,
    chromophores,
    from_coordinates,
    tissue_named,
)


def test_it_is_one_of_the_named_ones():
    assert tissue_named("measured2026b") is MEASURED2026B


def test_baseline_is_that_of_jacques():
    np.testing.assert_allclose(
        MEASURED2026B.baseline(WAVELENGTHS),
        chromophores.baseline_jacques(WAVELENGTHS, 0.244, 85.3),
        rtol=1e-12,
    )


def test_dermis_scatters_between_its_two_ends():
    """Mean free paths mix as the melanins do, so every skin lies between the ends."""
    pheo, eu = (MEASURED2026B.dermis_reduced_scattering(WAVELENGTHS, share) for share in (0.0, 1.0))
    np.testing.assert_allclose(pheo, 80.0 * (WAVELENGTHS / 500) ** -0.7)
    np.testing.assert_allclose(eu, 14.5 * (WAVELENGTHS / 500) ** -2.4)
    half = MEASURED2026B.dermis_reduced_scattering(WAVELENGTHS, [0.5])[0]
    np.testing.assert_allclose(2 / half, 1 / pheo + 1 / eu)


def test_slopes_of_measured_skins_are_inside_the_published_ones():
    """0.7 to 2.45 over 400–700 nm, between the skins that hold nine of ten [jacques2013]."""
    lam = np.array([400.0, 700.0])
    for share in (0.08, 0.6):
        ends = MEASURED2026B.dermis_reduced_scattering(lam, share)
        assert 0.7 <= np.log(ends[0] / ends[1]) / np.log(7 / 4) <= 2.45


def test_the_mixture_is_absorption_over_scattering():
    """What `_longer_paths` says: μa / μs of the dermis, times μs at the end of pheomelanin."""
    skins = from_coordinates(np.random.default_rng(0).random((50, 5)))
    recipe, above, below = MEASURED2026B.mixture(WAVELENGTHS)
    first = len(above) - 1
    found = absorption(skins, recipe[first:], below)
    values = dict(zip(NAMES, skins.T, strict=True))
    plain = MEASURED2026B.absorption("dermis", values, WAVELENGTHS)
    longer = MEASURED2026B.dermis_reduced_scattering(
        WAVELENGTHS
    ) / MEASURED2026B.dermis_reduced_scattering(WAVELENGTHS, skins[:, 3])
    np.testing.assert_allclose(found, plain * longer, rtol=1e-9)


def test_ends_that_do_not_scatter_are_refused():
    with pytest.raises(CutisError, match="dermis_by_type must hold two pairs"):
        Tissue(name="mine", dermis_by_type=((80.0, 0.7),))
    with pytest.raises(CutisError, match="above 0"):
        Tissue(name="mine", dermis_by_type=((80.0, 0.7), (0.0, 1.0)))
