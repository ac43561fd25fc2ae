"""Edits and masks of layers against NumPy and SciPy."""

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import gaussian_filter

from cutis.errors import CutisError
from cutis.looks import (
    Ceiling,
    Contrast,
    Floor,
    Layer,
    Look,
    Multiply,
    PicturePart,
    RangePart,
    RegionsPart,
    Set,
    Soften,
)
from cutis.maps import estimate
from cutis.optics import parameter

MELANIN = parameter("melanin")


@pytest.fixture(scope="module")
def skin(face_rgb):
    return estimate(np.tile(face_rgb, (4, 4, 1)))


def applied(skin, edit, *mask, amount=1.0):
    return skin.apply(Look(layers=(Layer(edits=(edit,), mask=mask, amount=amount),)))


def blurred(u, sigma):
    """A normalized Gaussian blur in coordinates: nothing is outside."""
    one = gaussian_filter(np.ones_like(u), sigma, mode="constant", truncate=5)
    return gaussian_filter(u, sigma, mode="constant", truncate=5) / one


def u_of(values):
    return np.asarray(MELANIN.to_coordinate(values.astype(np.float64)))


@pytest.mark.parametrize(("radius", "sigma"), [("3px", 3), (10 / 128, 10), ("30px", 30)])
def test_a_blur_is_that_of_scipy(skin, radius, sigma):
    found = u_of(applied(skin, Soften(map="melanin", radius=radius)).melanin)
    before = u_of(skin.melanin)
    expected = blurred(before, sigma)
    assert np.abs(found - expected).max() < 0.04 * np.ptp(before)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.006 * np.ptp(before)


def test_contrast_is_about_the_median_or_what_is_around(skin):
    before = u_of(skin.melanin)
    found = u_of(applied(skin, Contrast(map="melanin", by=0.5)).melanin)
    middle = np.median(before)
    assert np.abs(found - (middle + 0.5 * (before - middle))).max() < 0.01
    edit = Contrast(map="melanin", by=0.25, about="local", radius="4px")
    around = blurred(before, 4)
    expected = around + 0.25 * (before - around)
    found = u_of(applied(skin, edit).melanin)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.006 * np.ptp(before)


def test_detail_and_large_areas_together_do_what_the_whole_does(skin):
    before = u_of(skin.melanin)
    moved = {
        areas: u_of(applied(skin, Multiply(map="melanin", by=1.3, areas=areas,
                                           radius=None if areas == "all" else "5px")).melanin)
        - before
        for areas in ("all", "detail", "large")
    }  # fmt: skip
    np.testing.assert_allclose(moved["detail"] + moved["large"], moved["all"], atol=1e-5)
    assert np.abs(moved["detail"]).mean() < 0.3 * np.abs(moved["large"]).mean()


def test_floors_and_ceilings(skin):
    low, high = (float(np.quantile(skin.melanin, q)) for q in (0.3, 0.7))
    found = applied(skin, Floor(map="melanin", to=low)).melanin
    np.testing.assert_array_equal(found, np.maximum(skin.melanin, np.float32(low)))
    found = applied(skin, Ceiling(map="melanin", to=high)).melanin
    np.testing.assert_array_equal(found, np.minimum(skin.melanin, np.float32(high)))


def weight_of(skin, *mask):
    """The mask of a layer, by what it lets a change of oxygenation do."""
    found = applied(skin, Set(map="oxygenation", to=0.0), *mask).oxygenation
    return 1 - found / skin.oxygenation


def test_parts_add_subtract_and_intersect(skin, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    height, width = skin.shape
    a = np.linspace(0, 255, width).astype(np.uint8)[None].repeat(height, 0)
    Image.fromarray(a).save("a.png")
    Image.fromarray(a[:, ::-1].copy()).save("b.png")
    regions = Image.new("RGB", (width, height), "#000000")
    regions.paste("#c03030", (10, 20, 50, 60))
    regions.save("c.png")
    x, y = a / 255.0, a[:, ::-1] / 255.0
    one, two = PicturePart(path="a.png"), PicturePart(path="b.png")

    def how(part, **fields):
        return part.model_copy(update=fields)

    for mask, expected in [
        ((one, two), 1 - (1 - x) * (1 - y)),
        ((one, how(two, how="subtract")), x * (1 - y)),
        ((one, how(two, how="intersect", invert=True)), x * (1 - y)),
        ((how(one, how="subtract"),), 1 - x),
    ]:
        np.testing.assert_allclose(weight_of(skin, *mask), expected, atol=2e-6)
    cheek = RegionsPart(path="c.png", take=("cheek",), names={"cheek": "#C03030"})
    expected = np.zeros(skin.shape)
    expected[20:60, 10:50] = 1
    np.testing.assert_allclose(weight_of(skin, cheek), expected, atol=2e-6)
    soft = weight_of(skin, how(cheek, feather="3px"))
    assert np.abs(soft - blurred(expected, 3)).max() < 0.01


def test_ranges(skin):
    low, high = (float(np.quantile(skin.blood, q)) for q in (0.4, 0.8))
    t = np.clip((skin.blood - low) / (high - low), 0, 1)
    expected = t * t * (3 - 2 * t)
    found = weight_of(skin, RangePart(map="blood", above=(low, high)))
    np.testing.assert_allclose(found, expected, atol=1e-5)
    found = weight_of(skin, RangePart(map="blood", above=("p40", "p80")))
    assert np.abs(found - expected).max() < 0.05
    found = weight_of(skin, RangePart(map="blood", over="median", below=1.0))
    assert found.mean() == pytest.approx(0.5, abs=0.03)


def test_a_mask_of_another_size_or_missing_names_its_layer(skin, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Image.new("L", (7, 5), 255).save("small.png")
    for name, said in (("small.png", "the mask has 7 × 5 texels"), ("gone.png", "no file gone")):
        layer = Layer(name="lips", edits=(Multiply(map="blood", by=2),),
                      mask=(PicturePart(path=name),))  # fmt: skip
        with pytest.raises(CutisError, match=rf"layer 2 \(lips\), mask part 1: .*{said}"):
            skin.apply(Look(layers=(Layer(), layer)))
