"""The sRGB transfer function against its definition and colour-science."""

import numpy as np
import pytest

from cutis.colour import decode_srgb, encode_srgb


def test_exact_at_the_toe():
    """12.92 below 0.0031308, 1.055 x^(1/2.4) − 0.055 above [iec61966]."""
    assert encode_srgb(0.0031308) == 12.92 * 0.0031308
    assert decode_srgb(0.04045) == 0.04045 / 12.92
    assert encode_srgb(0.001) == pytest.approx(0.01292, rel=1e-15)
    above = np.nextafter(0.0031308, 1)
    assert encode_srgb(above) == pytest.approx(1.055 * above ** (1 / 2.4) - 0.055, rel=1e-15)
    assert encode_srgb(above) == pytest.approx(float(encode_srgb(0.0031308)), abs=3e-8)


def test_known_values():
    assert encode_srgb(0.0) == 0
    assert encode_srgb(1.0) == pytest.approx(1, abs=2e-16)
    assert encode_srgb(np.float32(1)) == pytest.approx(1, abs=1e-7)
    assert encode_srgb(0.18) == pytest.approx(0.46135613, abs=1e-8)
    assert decode_srgb(0.5) == pytest.approx(0.21404114, abs=1e-8)


def test_against_colour_science():
    from colour.models import eotf_inverse_sRGB, eotf_sRGB

    x = np.linspace(0, 1, 4001)
    np.testing.assert_allclose(encode_srgb(x), eotf_inverse_sRGB(x), atol=1e-15)
    np.testing.assert_allclose(decode_srgb(x), eotf_sRGB(x), atol=1e-8)  # theirs ends its toe
    # at the encoded 0.0031308 · 12.92 instead of the printed 0.04045


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_round_trip_and_order(dtype):
    x = np.linspace(-0.5, 4, 100_001).astype(dtype)
    encoded = encode_srgb(x)
    assert encoded.dtype == dtype
    assert np.all(np.diff(encoded) >= 0)
    tolerance = 1e-6 if dtype == np.float32 else 2e-8  # the printed toes meet to 2e-8
    np.testing.assert_allclose(decode_srgb(encoded), x, rtol=tolerance, atol=tolerance)


def test_odd_about_zero_and_integers():
    x = np.linspace(0, 2, 101)
    np.testing.assert_array_equal(encode_srgb(-x), -encode_srgb(x))
    np.testing.assert_array_equal(decode_srgb(-x), -decode_srgb(x))
    assert encode_srgb(1).dtype == np.float64
    assert encode_srgb(np.float16(1)).dtype == np.float64
