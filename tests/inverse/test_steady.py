"""Steady maps: against plain NumPy, in pieces, of flat and tiny textures, and what they are for."""

import dataclasses

import numpy as np
import pytest
from scipy.ndimage import correlate1d

import cutis
from cutis.colour import delta_e
from cutis.inverse import load_model
from cutis.inverse import steady as s
from cutis.maps.estimating import Surveyed, estimate_bands
from cutis.maps.source import ArrayCapture
from cutis.optics import NAMES, from_coordinates, to_coordinates

WEAK = ("thickness", "eumelanin", "oxygenation")


@pytest.fixture(scope="module")
def model():
    return load_model("measured2026b")


@pytest.fixture(scope="module")
def skin_rgb(model):
    """(80, 72, 3) a colour of skin with melanin spots, an edge of blood, and noise of hue."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:80, :72]
    u = np.empty((80, 72, 5))
    u[..., 0] = 0.22 + 0.04 * np.sin(x / 5) * np.sin(y / 7)
    u[..., 1] = np.where(x > 40, 0.33, 0.26)
    u[..., 2:] = (0.33, 0.45, 0.7)
    rgb = model.decode(from_coordinates(u))
    return (rgb * (1 + 0.004 * rng.standard_normal(rgb.shape))).astype(np.float32)


def found(model, rgb, cover=None, rounding=0.0):
    cover = np.ones(rgb.shape[:2], np.float32) if cover is None else cover
    maps = model.estimate(rgb, cover, {"rounding": rounding}, sigma=False).maps
    return np.stack([maps[name] for name in NAMES], axis=-1)


def rough(maps, name):
    values = to_coordinates(maps)[..., NAMES.index(name)]
    return np.abs(np.diff(values, axis=0)).mean() + np.abs(np.diff(values, axis=1)).mean()


def test_weak_maps_are_steadier_and_colours_are_kept(model, skin_rgb):
    own, steady = model.encode(skin_rgb), found(model, skin_rgb)
    for name in ("eumelanin", "oxygenation"):
        assert rough(steady, name) < 0.6 * rough(own, name)
    assert delta_e(model.decode(steady), skin_rgb).mean() < 0.1
    for name in ("melanin", "blood"):
        i = NAMES.index(name)
        assert np.corrcoef(own[..., i].ravel(), steady[..., i].ravel())[0, 1] > 0.97


def test_expectation_and_correction_are_those_of_numpy(model, skin_rgb):
    """The formulas of `steady.py`, gains worked out for each texel instead of tabulated."""
    steady = model.of_tile
    own = steady.skins(skin_rgb.reshape(-1, 3))
    inside = np.ones(skin_rgb.shape[:2], bool)
    fast = steady.steadied(skin_rgb, inside, own).reshape(80, 72, 5)

    u = own.reshape(80, 72, 5).astype(np.float64)
    m, b = u[..., :1], u[..., 1:2]
    terms = np.concatenate([np.ones_like(m), m, b, m * m, m * b, b * b, u[..., 2:],
                            m * u[..., 2:], b * u[..., 2:]], axis=-1)  # fmt: skip
    cells = terms.reshape(10, 8, 9, 8, 15).sum(axis=(1, 3))
    for axis in (0, 1):
        cells = correlate1d(cells, [1, 2, 1], axis, mode="constant")
    lines = s.guided(cells).astype(np.float64)
    whole = np.empty((80, 72, 9))
    for y in range(80):
        for x in range(72):
            p, q = (y + 0.5) / 8 - 0.5, (x + 0.5) / 8 - 0.5
            i, j = int(np.floor(p)), int(np.floor(q))
            rows, columns = np.clip([i, i + 1], 0, 9), np.clip([j, j + 1], 0, 8)
            weight = np.outer([1 - p + i, p - i], [1 - q + j, q - j])
            whole[y, x] = np.einsum("ij,ijk->k", weight, lines[np.ix_(rows, columns)])
    weak = whole[..., :3] * m + whole[..., 3:6] * b + whole[..., 6:]
    before = np.concatenate([m, b, np.clip(weak, 0, 1)], axis=-1).reshape(-1, 5)

    flat, slopes = skin_rgb.reshape(-1, 3), steady.slopes(own)
    trust = steady.trust(flat).astype(np.float64)
    by_unit = s.unit_slopes(own.astype(np.float64))[:, 2:]
    deviation = np.full((len(own), 5), s.STRONG)
    deviation[:, 2:] = np.array(s.FREE) * np.minimum(trust[:, 2:5] / by_unit, s.MOST)
    lever = slopes * deviation[:, None] ** 2
    inner = lever @ np.swapaxes(slopes, 1, 2) + s.unseen(flat)
    gain = np.swapaxes(np.linalg.solve(inner, lever), 1, 2)
    at = before
    for _ in range(2):
        wrong = flat - model.decode(from_coordinates(at)).astype(np.float64)
        wrong = wrong + np.einsum("ncp,np->nc", slopes, at - before)
        at = np.clip(before + np.einsum("npc,nc->np", gain, wrong), 0, 1)
    error = np.abs(fast.reshape(-1, 5) - at)
    assert np.median(error) < 1e-3
    assert np.percentile(error, 99) < 0.02


@pytest.mark.parametrize("rounding", [0.0, 1 / 255])
@pytest.mark.parametrize("height", [1, 16, 37, 64])
def test_bands_of_any_height_give_the_same(height, rounding, model, skin_rgb):
    cover = np.ones(skin_rgb.shape[:2], np.float32)
    cover[20:33, 10:50] = 0

    class Bands(ArrayCapture):
        def bands(self):
            for top in range(0, 80, height):
                yield slice(top, top + height)

    whole = found(model, skin_rgb, cover, rounding)
    parts = estimate_bands(Bands(skin_rgb, cover, rounding), model, Surveyed(), sigma=False)
    for rows, part in parts:
        np.testing.assert_array_equal(part.parameters(), whole[rows])


def test_flat_swatches_keep_their_own_estimate(model):
    """Nothing to learn from neighbours that are all alike."""
    flat = np.full((30, 40, 3), (0.42, 0.26, 0.19), np.float32)
    for rounding in (0.0, 1 / 255):
        steady, own = found(model, flat, rounding=rounding), model.encode(flat)
        np.testing.assert_allclose(to_coordinates(steady), to_coordinates(own), atol=5e-3)
        assert np.ptp(steady.reshape(-1, 5), axis=0).max() < 1e-3


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 1), (3, 5), (25, 8)])
def test_textures_smaller_than_the_filter(shape, model, skin_rgb):
    part = skin_rgb[: shape[0], : shape[1]]
    steady = found(model, part)
    assert np.isfinite(steady).all()
    assert delta_e(model.decode(steady), part).mean() < 0.15


def test_masks_of_single_texels_keep_their_own_estimate(model, skin_rgb):
    """Texels too far from each other to be neighbours."""
    cover = np.zeros(skin_rgb.shape[:2], np.float32)
    cover[4, 4] = cover[4, 68] = cover[70, 4] = 1
    steady, own = found(model, skin_rgb, cover), model.encode(skin_rgb)
    inside = cover > 0
    np.testing.assert_allclose(
        to_coordinates(steady[inside]), to_coordinates(own[inside]), atol=5e-3
    )
    assert not steady[~inside].any()


def test_no_skin_in_a_tile(model, skin_rgb):
    assert not found(model, skin_rgb, np.zeros(skin_rgb.shape[:2], np.float32)).any()


def test_colours_that_no_skin_has_stay_what_they_were(model, skin_rgb):
    rgb = skin_rgb.copy()
    rgb[30:40, 30:40] = (0.05, 0.3, 0.6)
    own, steady = model.encode(rgb), found(model, rgb)
    patch = np.s_[32:38, 32:38]
    far = [delta_e(model.decode(maps[patch]), rgb[patch]).mean() for maps in (own, steady)]
    assert far[1] < far[0] + 0.5
    away = np.s_[:20, :20]
    np.testing.assert_allclose(steady[away], found(model, skin_rgb)[away], rtol=2e-3)


def test_rounding_is_not_explained(model, skin_rgb):
    """8-bit texels of dark skin: blood is steadier than where rounding is taken for skin."""
    u = np.full((64, 64, 5), (0.62, 0.4, 0.3, 0.4, 0.6))
    u[..., 0] += 0.02 * np.sin(np.arange(64) / 9)
    from cutis.colour.transfer import decode_srgb, encode_srgb

    rgb = decode_srgb(np.round(encode_srgb(model.decode(from_coordinates(u))) * 255) / 255)
    rounded = found(model, rgb.astype(np.float32), rounding=1 / 255)
    taken = found(model, rgb.astype(np.float32))
    assert rough(rounded, "blood") < 0.8 * rough(taken, "blood")
    assert delta_e(model.decode(rounded), rgb.astype(np.float32)).max() < 2


def test_unedited_texels_come_back_bit_for_bit(skin_rgb):
    skin = cutis.estimate(skin_rgb, model="measured2026b", steady=True)
    np.testing.assert_array_equal(skin.albedo(), skin_rgb)
    np.testing.assert_array_equal(skin.multiply(melanin=1.0).albedo(), skin_rgb)


def test_off_is_every_texel_by_itself(skin_rgb, model):
    off = cutis.estimate(skin_rgb, model="measured2026b")
    np.testing.assert_array_equal(off.parameters(), model.encode(skin_rgb))
    on = cutis.estimate(skin_rgb, model="measured2026b", steady=True)
    assert not np.array_equal(on.thickness, off.thickness)
    assert model.alone.reach == 0
    assert model.alone == model
    np.testing.assert_array_equal(on.sigma("blood"), off.sigma("blood"))


def test_models_that_look_at_no_neighbours_are_their_own_off():
    plain = load_model("aliaga2022-exact")
    assert plain.alone is plain
    assert dataclasses.replace(plain).of_tile is None
