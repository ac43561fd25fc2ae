"""BioSkin's RGB network in PyTorch and ONNX Runtime, to be timed against.

3 → 70 → 70 → 70 → 5 and back, tanh inside, sigmoid out, weights random: for timing it does not
matter what they are. Both get the same weights, and the threads of everything else that is timed.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from cutis.inverse.device import torch_network
from cutis.inverse.network import Autoencoder, Perceptron, layer_sizes

Array: TypeAlias = NDArray[np.float32]
Step: TypeAlias = Callable[[Array], Array]
TILE = 16384
"""Texels per call where a call is not for all of them."""


def random_networks(seed: int = 0) -> Autoencoder:
    """An encoder and a decoder of the paper's shape with random weights."""
    rng = np.random.default_rng(seed)

    def perceptron(inputs: int, outputs: int) -> Perceptron:
        sizes = layer_sizes(inputs, outputs)
        weights = tuple(rng.standard_normal((o, i)) / np.sqrt(i) for i, o in sizes)
        biases = tuple(0.1 * rng.standard_normal(o) for _, o in sizes)
        return Perceptron(
            tuple(w.astype(np.float32) for w in weights),
            tuple(b.astype(np.float32) for b in biases),
        )

    return Autoencoder(perceptron(3, 5), perceptron(5, 3))


def torch_step(network: Perceptron, threads: int) -> Step:
    """The network in PyTorch on the CPU; ModuleNotFoundError where PyTorch is not."""
    import torch

    torch.set_num_threads(threads)
    return torch_network(network, "cpu")


def onnx_step(network: Perceptron, threads: int) -> Step:
    """The network in ONNX Runtime on the CPU; ModuleNotFoundError where it is not."""
    import onnx
    import onnxruntime
    from onnx import TensorProto, helper, numpy_helper

    nodes, constants, last = [], [], len(network.weights) - 1
    for i, (weight, bias) in enumerate(zip(network.weights, network.biases, strict=True)):
        constants += [
            numpy_helper.from_array(weight, f"w{i}"),
            numpy_helper.from_array(bias, f"b{i}"),
        ]
        kind = "Tanh" if i < last else "Sigmoid"
        nodes.append(helper.make_node("Gemm", [f"x{i}", f"w{i}", f"b{i}"], [f"z{i}"], transB=1))
        nodes.append(helper.make_node(kind, [f"z{i}"], [f"x{i + 1}"]))
    ends = [("x0", network.weights[0].shape[1]), (f"x{last + 1}", len(network.biases[-1]))]
    inputs, outputs = (
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["texels", size])]
        for name, size in ends
    )
    graph = helper.make_graph(nodes, "network", inputs, outputs, constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=10)
    onnx.checker.check_model(model)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    session = onnxruntime.InferenceSession(
        model.SerializeToString(), options, providers=["CPUExecutionProvider"]
    )
    return lambda values: np.asarray(session.run(None, {"x0": values})[0], dtype=np.float32)


def tiled(step: Step, outputs: int) -> Step:
    """The same in calls of TILE texels."""

    def in_tiles(values: Array) -> Array:
        out = np.empty((len(values), outputs), dtype=np.float32)
        for start in range(0, len(values), TILE):
            out[start : start + TILE] = step(values[start : start + TILE])
        return out

    return in_tiles
