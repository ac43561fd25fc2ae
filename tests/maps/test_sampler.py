"""What calibration looks at does not depend on how an image comes."""

import numpy as np
import pytest

from cutis.maps import sampler as module
from cutis.maps.sampler import Sampler


def gathered(colours, cover, bands):
    sampler = Sampler(cover.size)
    passes = 0
    while not sampler.enough():
        passes += 1
        for first, last in bands:
            sampler.add(first, colours[first:last], cover[first:last])
    return sampler.colours(), passes


@pytest.fixture
def image():
    random = np.random.default_rng(0)
    return random.random((97, 61, 3), dtype=np.float32), random.random((97, 61), dtype=np.float32)


@pytest.mark.parametrize("limit", [97 * 61, 900, 50])
def test_bands_do_not_matter(image, limit, monkeypatch):
    monkeypatch.setattr(module, "SAMPLE", limit)
    monkeypatch.setattr(module, "ENOUGH", limit // 20)
    whole, _ = gathered(*image, [(0, 97)])
    for step in (1, 7, 40):
        bands = [(top, min(97, top + step)) for top in range(0, 97, step)]
        np.testing.assert_array_equal(gathered(*image, bands)[0], whole)
    assert len(whole) <= limit


def test_small_masks_are_looked_at_more_closely(image, monkeypatch):
    monkeypatch.setattr(module, "SAMPLE", 60)
    colours, _ = image
    cover = np.zeros((97, 61), np.float32)
    cover[40:45, 30:34] = 1
    found, passes = gathered(colours, cover, [(0, 50), (50, 97)])
    assert passes > 1
    assert len(found) == 20


def test_soft_masks_count_where_nothing_is_sure(image):
    colours, _ = image
    found, _ = gathered(colours, np.full((97, 61), 0.3, np.float32), [(0, 97)])
    assert len(found) == 97 * 61
    cover = np.full((97, 61), 0.3, np.float32)
    cover[0, 0] = 0.6
    np.testing.assert_array_equal(gathered(colours, cover, [(0, 97)])[0], colours[:1, 0])
