"""The baked σ and confidence against those of the prior itself."""

import numpy as np
import pytest

from cutis.albedo import albedo_space, halton
from cutis.colour import delta_e
from cutis.inverse.baked import MEASURED_CHART, RAW, Baked
from cutis.inverse.prior import DARK, unit_slopes
from cutis.inverse.shipped import shipped_prior
from cutis.maps import load_model
from cutis.optics import MEASURED2026, from_coordinates

RNG = np.random.default_rng(12)


@pytest.fixture(scope="module")
def colours() -> np.ndarray:
    """Colours of measured skin."""
    prior = shipped_prior()
    whitened = 0.7 * RNG.standard_normal((800, 3))
    return (
        (np.exp(whitened @ np.linalg.inv(prior.whitening).T + prior.centre) - DARK)
        .clip(0.002)
        .astype(np.float32)
    )


@pytest.fixture(scope="module")
def exact(colours) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates, σ in units and confidence without tables."""
    prior, space = shipped_prior(), albedo_space(MEASURED2026)
    u = prior.skins(space, colours).astype(float)
    sigma, confidence = prior.trust(space, colours, u)
    return u, sigma * unit_slopes(u), confidence


def test_skins_are_those_of_the_prior(colours, exact):
    """Where the fit saturates, at ends of ranges, splines round it off: a tail of some per cent."""
    model, (u, _, confidence) = load_model(), exact
    known = confidence > 0.9
    direct = albedo_space(MEASURED2026).rgb(from_coordinates(u))
    error = delta_e(model.decode(model.encode(colours)), direct)[known]
    assert np.median(error) < 0.01
    assert np.percentile(error, 95) < 0.12
    off = np.abs(model.encode(colours) - from_coordinates(u))[known] / unit_slopes(u)[known]
    assert np.median(off, axis=0).max() < 1e-3
    assert np.percentile(off, 95, axis=0).max() < 0.015


def test_trust_is_that_of_the_prior(colours, exact):
    _, sigma, confidence = exact
    found = load_model().trust(colours)
    known = confidence > 0.9
    ratio = found[known, :5] / sigma[known]
    assert np.all(np.abs(np.median(ratio, axis=0) - 1) < 0.01)
    assert np.all(np.percentile(np.abs(np.log(ratio)), 95, axis=0) < 0.1)
    assert np.abs(found[:, 5] - confidence).mean() < 0.02


def test_trust_of_anything_is_a_number_or_tells_of_its_colour():
    odd = np.array([[0, 0, 0], [1, 1, 1], [-1, 0.2, 5], [0, 0, 9]], np.float32)
    found = load_model().trust(odd)
    assert np.isfinite(found).all()
    assert (found[:, :5] > 0).all()
    assert np.all((found[:, 5] >= 0) & (found[:, 5] <= 0.2))


def test_the_chart_holds_the_albedo_space():
    rgb = np.maximum(albedo_space(MEASURED2026).rgb(from_coordinates(halton(20_000))), 1e-6)
    red, green, blue = rgb.T
    for values, low, high in zip(
        (green**0.25, red / (red + green), blue / (blue + green)),
        MEASURED_CHART.low, MEASURED_CHART.high, strict=True,
    ):  # fmt: skip
        assert low <= values.min()
        assert values.max() <= high


def test_raw_values_are_the_plain_sum():
    coefficients = RNG.standard_normal((6, 7, 8, 6)).astype(np.float32)
    from cutis.inverse.baked import Chart
    from cutis.kernels.splines import basis

    chart = Chart((0.3, 0.4, 0.1), (0.9, 0.9, 0.6), (3, 4, 5))
    a, b, c = RNG.uniform((0.3, 0.4, 0.1), (0.9, 0.9, 0.6), (200, 3)).T
    rgb = np.stack([a**4 * b / (1 - b), a**4, a**4 * c / (1 - c)], axis=1)
    ends = zip((a, b, c), chart.low, chart.high, chart.cells, strict=True)
    bases = [basis((x - low) / (high - low), n) for x, low, high, n in ends]
    plain = np.einsum("na,nb,nc,abcp->np", *bases, coefficients, optimize=True)
    table = Baked(coefficients, chart)
    assert RAW == 2
    np.testing.assert_allclose(table.values(rgb), plain, atol=2e-3)
