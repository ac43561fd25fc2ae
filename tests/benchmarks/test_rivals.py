"""BioSkin's network in other frameworks computes what the plain form does."""

import numpy as np
import pytest

from benchmarks.rivals import TILE, onnx_step, random_networks, tiled, torch_step

NETWORKS = random_networks()
RGB = np.random.default_rng(0).random((500, 3), dtype=np.float32)


@pytest.mark.parametrize(("make", "package"), [(torch_step, "torch"), (onnx_step, "onnxruntime")])
def test_agrees_with_the_plain_form(make, package):
    pytest.importorskip(package)
    encode, decode = make(NETWORKS.encoder, 1), make(NETWORKS.decoder, 1)
    skins = NETWORKS.encoder.reference(RGB).astype(np.float32)
    np.testing.assert_allclose(encode(RGB), skins, atol=1e-5)
    np.testing.assert_allclose(decode(skins), NETWORKS.decoder.reference(skins), atol=1e-5)


def test_tiles_are_the_whole():
    values = np.random.default_rng(1).random((TILE + 100, 3), dtype=np.float32)
    sizes = []

    def step(part):
        sizes.append(len(part))
        return np.hstack([part, part[:, :2]]) + 1

    np.testing.assert_array_equal(tiled(step, 5)(values), step(values))
    assert sizes == [TILE, 100, TILE + 100]


def test_the_same_random_networks_every_time():
    np.testing.assert_array_equal(random_networks().encoder(RGB), NETWORKS.encoder(RGB))
    assert np.ptp(NETWORKS.encoder(RGB)) > 0.05
