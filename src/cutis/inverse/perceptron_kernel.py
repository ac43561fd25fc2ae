"""Compiled forward pass of a small perceptron over many texels.

A tile of texels goes through all layers while it is in the nearest cache, a few outputs of each
layer at a time (`kernels/lanes.py`), followed by what their sums go through. PyPI's Numba has no
vector tanh, so tanh is a rational function (odd, degree 13 over 6, error below 1e-6 in float32,
the form that Eigen uses), which the compiler vectorises.
"""

from typing import Any

import numpy as np

from cutis.kernels.compiling import compiled, on_all_cores
from cutis.kernels.lanes import LANES, OUTPUTS, dense_block

TILE = 64
"""Texels that go through the layers together."""
TASK = 16
"""Tiles that a thread works on at a time."""
HALF = np.float32(0.5)

P1, P3, P5, P7 = (
    np.float32(4.89352455891786e-03),
    np.float32(6.37261928875436e-04),
    np.float32(1.48572235717979e-05),
    np.float32(5.12229709037114e-08),
)
P9, P11, P13 = (
    np.float32(-8.60467152213735e-11),
    np.float32(2.00018790482477e-13),
    np.float32(-2.76076847742355e-16),
)
Q0, Q2, Q4, Q6 = (
    np.float32(4.89352518554385e-03),
    np.float32(2.26843463243900e-03),
    np.float32(1.18534705686654e-04),
    np.float32(1.19825839466702e-06),
)
LIMIT = np.float32(7.9)


@compiled(fast=True, inline=True)
def _tanh(x: Any) -> Any:
    x = min(max(x, -LIMIT), LIMIT)
    s = x * x
    p = P1 + s * (P3 + s * (P5 + s * (P7 + s * (P9 + s * (P11 + s * P13)))))
    return x * p / (Q0 + s * (Q2 + s * (Q4 + s * Q6)))


@compiled(fast=True)
def _tile(x: Any, weights: Any, biases: Any, sizes: Any, out: Any, a: Any, b: Any) -> None:
    n = x.shape[0]
    for t in range(n):
        for i in range(sizes[0]):
            a[i, t] = x[t, i]
    last = weights.shape[0] - 1
    for layer in range(last + 1):
        outputs = sizes[layer + 1]
        for block in range((outputs + OUTPUTS - 1) // OUTPUTS):
            for first in range(0, TILE, LANES):
                dense_block(weights[layer], biases[layer], block, sizes[layer], a, first, b)
            for o in range(block * OUTPUTS, min(outputs, (block + 1) * OUTPUTS)):
                row = b[o]
                if layer < last:
                    for t in range(TILE):
                        row[t] = _tanh(row[t])
                else:  # sigmoid(x) = ½ + ½ tanh(x / 2)
                    for t in range(TILE):
                        row[t] = HALF + HALF * _tanh(HALF * row[t])
        a, b = b, a
    for t in range(n):
        for o in range(out.shape[1]):
            out[t, o] = a[o, t]


@on_all_cores(TILE * TASK, fast=True)
def forward(start: Any, stop: Any, x: Any, weights: Any, biases: Any, sizes: Any, out: Any) -> None:
    """Fills out (n, outputs) from x (n, inputs).

    `weights` (layers, blocks, inputs, OUTPUTS) and `biases` (layers, blocks · OUTPUTS) are padded
    with zeros to one size; `sizes` are the inputs of each layer and the outputs of the last.
    """
    width = max(weights.shape[2], biases.shape[1])
    a = np.zeros((width, TILE), dtype=np.float32)
    b = np.zeros((width, TILE), dtype=np.float32)
    for low in range(start, stop, TILE):
        high = min(stop, low + TILE)
        _tile(x[low:high], weights, biases, sizes, out[low:high], a, b)
