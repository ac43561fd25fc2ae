"""The colour table: its plain form, its round trip, its error against the exact space."""

import io
from dataclasses import replace

import numpy as np
import pytest

from cutis.albedo import albedo_space, uniform
from cutis.albedo.colour_table import (
    AXES,
    CELLS,
    ENDS,
    TERMS,
    build_colours,
    colour_table,
    from_axis,
    load_colours,
    save_colours,
    to_axis,
)
from cutis.colour import delta_e
from cutis.optics import ALIAGA2022, PARAMETERS, TISSUES

# Largest error in linear RGB, ΔE00 at the 99th percentile and at most. What scatters by melanin
# type needs a finer table; with the same nodes 6.7e-4, 8.2e-4 at the ends, 0.026 (0.036 on a face)
# and 0.058 were measured.
USUAL, SCATTERING = (3e-4, 0.01, 0.04), (1e-3, 0.04, 0.08)


def limits(tissue):
    return SCATTERING if tissue.dermis_by_type else USUAL


SKINS = uniform(3000, seed=21).astype(np.float32)


def test_kernel_is_the_plain_sum():
    ends = np.array(
        [[(p.low, p.high)[(k >> i) & 1] for i, p in enumerate(PARAMETERS)] for k in range(32)]
    )
    skins = np.concatenate([SKINS, ends]).astype(np.float32)
    table = colour_table(ALIAGA2022)
    np.testing.assert_allclose(table.rgb(skins), table.reference(skins), atol=2e-6)


@pytest.mark.parametrize("tissue", TISSUES.values(), ids=TISSUES)
def test_colours_of_random_skins_are_those_of_the_exact_space(tissue):
    skins = uniform(60_000, seed=22)
    exact, table = albedo_space(tissue).rgb(skins), colour_table(tissue).rgb(skins)
    largest, usual, worst = limits(tissue)
    assert np.abs(exact - table).max() < largest  # measured 1.5e-4
    errors = delta_e(exact, table)
    assert np.percentile(errors, 99) < usual  # 0.0059 and 0.0065
    assert errors.max() < worst  # 0.016 and 0.016


def test_another_tissue_of_a_known_name_is_not_read_from_the_file():
    thin = replace(ALIAGA2022, hemoglobin=75.0)
    skins = SKINS[:500]
    found = colour_table(thin).rgb(skins)
    np.testing.assert_allclose(found, albedo_space(thin).rgb(skins), atol=3e-4)
    assert np.abs(found - colour_table(ALIAGA2022).rgb(skins)).max() > 0.01


@pytest.mark.parametrize("tissue", TISSUES.values(), ids=TISSUES)
def test_ends_of_the_ranges_too(tissue):
    corners = np.array(np.meshgrid(*[(p.low, p.high) for p in PARAMETERS], indexing="ij"))
    corners = corners.reshape(5, -1).T
    exact = albedo_space(tissue).rgb(corners)
    assert np.abs(colour_table(tissue).rgb(corners) - exact).max() < limits(tissue)[0]


@pytest.mark.shared
def test_faces_decode_as_by_the_exact_space(shared_data):
    from cutis.maps import load_model
    from studies.figures.subjects import every_face

    count = 0
    for name, colours in every_face(shared_data, 4000):
        skins = load_model("aliaga2022-exact").encode(colours)
        for tissue in TISSUES.values():
            errors = delta_e(albedo_space(tissue).rgb(skins), colour_table(tissue).rgb(skins))
            assert np.percentile(errors, 99) <= limits(tissue)[1], (name, tissue.name)
        count += 1
    assert count > 10


@pytest.mark.parametrize("tissue", TISSUES.values(), ids=TISSUES)
def test_what_ships_is_what_is_built(tissue):
    built, shipped = build_colours(albedo_space(tissue)), colour_table(tissue)
    np.testing.assert_allclose(built.rgb(SKINS), shipped.rgb(SKINS), atol=2e-6)


def test_round_trip_and_size(tmp_path):
    table = colour_table(ALIAGA2022)
    file = io.BytesIO()
    save_colours(table, file)
    assert len(file.getvalue()) < 1e6
    file.seek(0)
    again = load_colours(file)
    np.testing.assert_array_equal(again.upper, table.upper)
    np.testing.assert_array_equal(again.lower, table.lower)
    assert table.upper.shape == (*(n + 2 for n in CELLS[:3]), TERMS)
    assert table.lower.shape == (3, *(n + 2 for n in CELLS[3:]), TERMS)


def test_axes_are_there_and_back():
    for i, p in enumerate(AXES):
        values = np.linspace(p.low, p.high, 50)
        np.testing.assert_allclose(from_axis(i, to_axis(i, values)), values, rtol=1e-12)
        assert ENDS[i][0] < ENDS[i][1]


def test_shapes_and_skins_that_are_not_numbers():
    table = colour_table(ALIAGA2022)
    grid = SKINS[:60].reshape(4, 15, 5)
    assert table.rgb(grid).shape == (4, 15, 3)
    assert table.rgb(grid).dtype == np.float32
    np.testing.assert_array_equal(table.rgb(grid).reshape(-1, 3), table.rgb(SKINS[:60]))
    assert table.rgb(SKINS[0]).shape == (3,)
    assert table.rgb(np.empty((0, 5))).shape == (0, 3)
    spoilt = SKINS[:200].copy()
    spoilt[3] = np.nan
    spoilt[5] = [-1, np.inf, -60, 1e30, -1e30]
    good = np.delete(np.arange(200), [3, 5])
    np.testing.assert_array_equal(table.rgb(spoilt)[good], table.rgb(SKINS[:200])[good])
