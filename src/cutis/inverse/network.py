"""The encoder and decoder of the paper as plain arrays, evaluated without PyTorch.

Four fully connected layers, two of them 70 × 70, tanh inside, sigmoid out [aliaga2022]. The
encoder turns linear sRGB into network coordinates u, the decoder u into linear sRGB.
Weights are stored as safetensors: `encoder.0.weight` (out, in), `encoder.0.bias` (out,), …
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutis.errors import CutisError

HIDDEN = 70
"""Neurons of each hidden layer."""
LAYERS = 4
"""Fully connected layers of the encoder, and of the decoder."""


@dataclass(frozen=True, eq=False)
class Perceptron:
    """Fully connected layers: `weights[i]` (out, in) and `biases[i]` (out,), float32."""

    weights: tuple[NDArray[np.float32], ...]
    biases: tuple[NDArray[np.float32], ...]

    def __call__(self, values: ArrayLike) -> NDArray[np.float32]:
        """(..., inputs) → (..., outputs) in (0, 1), float32, on all cores."""
        from cutis.inverse.perceptron_kernel import forward

        x = np.ascontiguousarray(values, dtype=np.float32)
        flat = x.reshape(-1, x.shape[-1])
        out = np.empty((len(flat), len(self.biases[-1])), dtype=np.float32)
        forward(len(flat), flat, *self._packed, out)
        return out.reshape(*x.shape[:-1], out.shape[1])

    def reference(self, values: ArrayLike) -> NDArray[np.float64]:
        """The same in plain float64 NumPy: the oracle of the fast form."""
        x = np.asarray(values, dtype=np.float64)
        for i, (w, b) in enumerate(zip(self.weights, self.biases, strict=True)):
            x = x @ w.T.astype(np.float64) + b
            x = np.tanh(x) if i < len(self.weights) - 1 else 1.0 / (1.0 + np.exp(-x))
        return x

    @cached_property
    def _packed(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64]]:
        """Weights (layers, blocks, inputs, OUTPUTS), biases and sizes as the kernel takes them."""
        from cutis.kernels.lanes import OUTPUTS

        sizes = [self.weights[0].shape[1], *(len(b) for b in self.biases)]
        blocks = -(-max(sizes[1:]) // OUTPUTS)
        w = np.zeros((len(self.weights), max(sizes[:-1]), blocks * OUTPUTS), dtype=np.float32)
        b = np.zeros((len(self.weights), blocks * OUTPUTS), dtype=np.float32)
        for i, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            w[i, : weight.shape[1], : weight.shape[0]] = weight.T
            b[i, : len(bias)] = bias
        w = w.reshape(len(w), -1, blocks, OUTPUTS).swapaxes(1, 2)
        return np.ascontiguousarray(w), b, np.array(sizes)


@dataclass(frozen=True)
class Autoencoder:
    """Encoder (linear sRGB → coordinates) and decoder (coordinates → linear sRGB)."""

    encoder: Perceptron
    decoder: Perceptron


def load_weights(file: Path) -> Autoencoder:
    """Reads a safetensors file of weights; raises CutisError when it is not one."""
    from safetensors.numpy import load_file

    try:
        tensors = load_file(file)
        encoder = _perceptron(tensors, "encoder", layer_sizes(3, 5))
        decoder = _perceptron(tensors, "decoder", layer_sizes(5, 3))
    except Exception as error:
        raise CutisError(f"{file.name}: not a file of encoder and decoder weights") from error
    return Autoencoder(encoder, decoder)


def _perceptron(
    tensors: dict[str, NDArray[np.generic]], half: str, sizes: Sequence[tuple[int, int]]
) -> Perceptron:
    weights, biases = [], []
    for i, (inputs, outputs) in enumerate(sizes):
        weight, bias = tensors[f"{half}.{i}.weight"], tensors[f"{half}.{i}.bias"]
        if weight.shape != (outputs, inputs) or bias.shape != (outputs,):
            raise ValueError(f"layer {i} of the {half} has another size")
        weights.append(weight.astype(np.float32))
        biases.append(bias.astype(np.float32))
        if not (np.isfinite(weights[-1]).all() and np.isfinite(biases[-1]).all()):
            raise ValueError(f"layer {i} of the {half} holds NaN or infinity")
    return Perceptron(tuple(weights), tuple(biases))


def layer_sizes(inputs: int, outputs: int) -> Sequence[tuple[int, int]]:
    """(in, out) of each layer: 3 → 70 → 70 → 70 → 5 for the encoder."""
    sizes = [inputs, *[HIDDEN] * (LAYERS - 1), outputs]
    return list(pairwise(sizes))
