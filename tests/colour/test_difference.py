"""CIELAB, CIEDE2000 and ITA° against formulae written out here."""

import numpy as np
import pytest
from colour.difference import delta_E_CIE2000

from cutis.colour import decode_srgb, delta_e, is_skin_colour, ita, lab
from cutis.colour.spectra import XYZ_TO_SRGB
from cutis.kernels import difference_kernel

SKINS = np.random.default_rng(5).random((200, 3)) * [0.8, 0.5, 0.4]


def lab_by_hand(rgb):
    xyz = np.asarray(rgb, dtype=float) @ np.linalg.inv(XYZ_TO_SRGB).T
    white = np.array([0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290])
    t = xyz / white
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.stack(
        [
            116 * f[..., 1] - 16,
            500 * (f[..., 0] - f[..., 1]),
            200 * (f[..., 1] - f[..., 2]),
        ],
        axis=-1,
    )


def ciede2000(a, b):
    """One pair of Lab triples [sharma2005ciede2000]."""
    (l1, a1, b1), (l2, a2, b2) = a, b
    mean_c = (np.hypot(a1, b1) + np.hypot(a2, b2)) / 2
    g = 0.5 * (1 - np.sqrt(mean_c**7 / (mean_c**7 + 25.0**7)))
    a1, a2 = (1 + g) * a1, (1 + g) * a2
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = (np.degrees(np.arctan2(y, x)) % 360 for x, y in ((a1, b1), (a2, b2)))
    dl, dc, dh = l2 - l1, c2 - c1, h2 - h1
    if c1 * c2 == 0:
        dh = 0
    elif abs(dh) > 180:
        dh -= np.copysign(360, dh)
    dh = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(dh / 2))
    ml, mc, mh = (l1 + l2) / 2, (c1 + c2) / 2, h1 + h2
    if c1 * c2 != 0:
        mh = mh / 2 if abs(h1 - h2) <= 180 else (mh + 360 if mh < 360 else mh - 360) / 2
    cosine = [np.cos(np.radians(k * mh + p)) for k, p in ((1, -30), (2, 0), (3, 6), (4, -63))]
    t = 1 - 0.17 * cosine[0] + 0.24 * cosine[1] + 0.32 * cosine[2] - 0.20 * cosine[3]
    rt = -2 * np.sqrt(mc**7 / (mc**7 + 25.0**7))
    rt *= np.sin(np.radians(60 * np.exp(-(((mh - 275) / 25) ** 2))))
    sl = 1 + 0.015 * (ml - 50) ** 2 / np.sqrt(20 + (ml - 50) ** 2)
    x, y, z = dl / sl, dc / (1 + 0.045 * mc), dh / (1 + 0.015 * mc * t)
    return np.sqrt(x * x + y * y + z * z + rt * y * z)


SHARMA = [  # pairs 1–3, 7, 9, 13, 17, 19, 25 and 34 of table 1 [sharma2005ciede2000]
    ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
    ((50, 3.1571, -77.2803), (50, 0, -82.7485), 2.8615),
    ((50, 2.8361, -74.0200), (50, 0, -82.7485), 3.4412),
    ((50, 0, 0), (50, -1, 2), 2.3669),
    ((50, 2.4900, -0.0010), (50, -2.4900, 0.0009), 7.1792),
    ((50, -0.0010, 2.4900), (50, 0.0009, -2.4900), 4.8045),
    ((50, 2.5, 0), (73, 25, -18), 27.1492),
    ((50, 2.5, 0), (56, -27, -3), 31.9030),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
]


@pytest.mark.parametrize(("first", "second", "expected"), SHARMA)
def test_published_pairs(first, second, expected):
    """Both the formula above and the compiled one give the published numbers."""
    assert ciede2000(first, second) == pytest.approx(expected, abs=6e-5)
    values = (float(v) for v in (*first, *second))
    assert difference_kernel.colour_difference(*values) == pytest.approx(expected, abs=6e-5)


def test_against_colour_science():
    """Random pairs, alike and far apart, hues on both sides of 0 and 360."""
    random = np.random.default_rng(3)
    one = random.random((5000, 3))
    two = np.clip(one + random.normal(0, [[0.01], [0.3]] * 2500, one.shape), 0, 1)
    expected = delta_E_CIE2000(lab_by_hand(one), lab_by_hand(two))
    np.testing.assert_allclose(delta_e(one, two), expected, atol=2e-5)
    kept = delta_e(one.astype(np.float32), two.astype(np.float32))
    np.testing.assert_allclose(kept, expected, atol=2e-3)


def test_lab_by_hand():
    np.testing.assert_allclose(lab(SKINS), lab_by_hand(SKINS), atol=2e-5)
    assert lab(SKINS.reshape(10, 20, 3)).shape == (10, 20, 3)


def test_greys_are_neutral():
    greys = np.linspace(0, 1, 11)[:, None] * np.ones(3)
    values = lab(greys)
    np.testing.assert_allclose(values[:, 1:], 0, atol=1e-5)
    assert values[0, 0] == pytest.approx(0, abs=1e-5)
    assert values[-1, 0] == pytest.approx(100, abs=1e-5)
    assert lab([0.18418651851] * 3)[0] == pytest.approx(50, abs=1e-4)


def test_delta_e_by_hand():
    other = SKINS[::-1]
    pairs = zip(lab_by_hand(SKINS), lab_by_hand(other), strict=True)
    expected = [ciede2000(a, b) for a, b in pairs]
    np.testing.assert_allclose(delta_e(SKINS, other), expected, atol=1e-4)
    np.testing.assert_array_equal(delta_e(SKINS, SKINS), 0)
    assert delta_e(SKINS.reshape(10, 20, 3), other.reshape(10, 20, 3)).shape == (10, 20)


def test_ita_by_hand():
    """arctan((L* − 50) / b*) in degrees [chardon1991ita]."""
    values = lab_by_hand(SKINS)
    good = values[:, 2] > 1
    expected = np.degrees(np.arctan((values[:, 0] - 50) / values[:, 2]))
    np.testing.assert_allclose(ita(SKINS)[good], expected[good], atol=1e-3)


def test_ita_of_two_faces():
    light, dark = decode_srgb([0.91, 0.76, 0.68]), decode_srgb([0.30, 0.20, 0.15])
    assert 41 < ita(light) < 75
    assert ita(dark) < -30


def test_skin_colours():
    assert is_skin_colour(decode_srgb([0.8, 0.6, 0.5]))
    assert not is_skin_colour([0.5, 0.5, 0.5])
    assert not is_skin_colour([0.02, 0.01, 0.005])
    assert is_skin_colour(SKINS.reshape(10, 20, 3)).shape == (10, 20)
