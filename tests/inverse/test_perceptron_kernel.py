"""The compiled forward pass against plain NumPy in double precision."""

import numpy as np
import pytest

from cutis.inverse.network import Perceptron, layer_sizes


def perceptron(scale: float, inputs: int = 3, outputs: int = 5) -> Perceptron:
    rng = np.random.default_rng(7)
    sizes = layer_sizes(inputs, outputs)
    weights = tuple(
        (scale * rng.standard_normal((o, i)) / np.sqrt(i)).astype(np.float32) for i, o in sizes
    )
    biases = tuple((scale * 0.1 * rng.standard_normal(o)).astype(np.float32) for _, o in sizes)
    return Perceptron(weights, biases)


@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
@pytest.mark.parametrize(("inputs", "outputs"), [(3, 5), (5, 3)])
def test_agrees_with_the_reference(count, inputs, outputs):
    net = perceptron(1.0, inputs, outputs)
    x = np.random.default_rng(count).random((count, inputs), dtype=np.float32)
    np.testing.assert_allclose(net(x), net.reference(x), rtol=0, atol=3e-6)


def test_saturates_without_leaving_the_unit_interval():
    net = perceptron(30.0)
    x = np.random.default_rng(0).uniform(-50, 50, (500, 3)).astype(np.float32)
    out = net(x)
    assert out.min() >= -1e-6
    assert out.max() <= 1 + 1e-6
    assert np.ptp(out) > 0.99


def test_keeps_the_shape_of_the_image_and_takes_strided_input():
    net = perceptron(1.0)
    image = np.random.default_rng(1).random((4, 6, 9, 3))
    every_other = image[:, ::2, ::3]
    assert net(every_other).shape == (4, 3, 3, 5)
    np.testing.assert_array_equal(net(every_other), net(every_other.copy()))


def test_no_texels_give_no_texels():
    assert perceptron(1.0)(np.zeros((0, 3))).shape == (0, 5)
