"""The encoder and decoder networks as ONNX, units and network coordinates included.

`skin` (n, 5) holds the five parameters in their units, `rgb` (n, 3) linear sRGB under D65, as
`Model.decode` and `Model.encode` have them. Needs the package onnx (`pip install 'cutis[onnx]'`).
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutis.errors import CutisError
from cutis.inverse.network import Autoencoder, Perceptron
from cutis.optics.parameters import NAMES, PARAMETERS

OPSET = 17
"""Version of the standard's operators: of 2022, which every run-time in use knows."""
IR_VERSION = 8
"""Version of the file format that came with it."""


def decoder_onnx(networks: Autoencoder) -> bytes:
    """The decoder, `skin` → `rgb`, as the bytes of an .onnx file."""
    graph = Graph()
    roots, lows, spans = _coordinates()
    value = graph.add("Pow", "skin", graph.constant("roots", 1 / roots))
    value = graph.add("Sub", value, graph.constant("lows", lows))
    value = graph.add("Div", value, graph.constant("spans", spans))
    value = graph.perceptron(value, networks.decoder)
    return graph.finish(value, ("skin", 5), ("rgb", 3), f"skin: {', '.join(NAMES)}")


def encoder_onnx(networks: Autoencoder) -> bytes:
    """The encoder, calibrated `rgb` → `skin`, as the bytes of an .onnx file."""
    graph = Graph()
    roots, lows, spans = _coordinates()
    value = graph.perceptron("rgb", networks.encoder)
    value = graph.add("Mul", value, graph.constant("spans", spans))
    value = graph.add("Add", value, graph.constant("lows", lows))
    value = graph.add("Pow", value, graph.constant("roots", roots))
    value = graph.add("Max", value, graph.constant("low", [p.low for p in PARAMETERS]))
    value = graph.add("Min", value, graph.constant("high", [p.high for p in PARAMETERS]))
    return graph.finish(value, ("rgb", 3), ("skin", 5), f"skin: {', '.join(NAMES)}")


def _coordinates() -> tuple[Any, Any, Any]:
    """Root of each parameter, its lowest value under the root, and the span of its values there."""
    roots = np.array([p.root for p in PARAMETERS], dtype=np.float64)
    lows = np.array([p.low for p in PARAMETERS]) ** (1 / roots)
    highs = np.array([p.high for p in PARAMETERS]) ** (1 / roots)
    return roots, lows, highs - lows


class Graph:
    """Operators one after the other."""

    def __init__(self) -> None:
        try:
            import onnx
        except ImportError as error:
            raise CutisError(
                "ONNX files need the package onnx: pip install 'cutis[onnx]'"
            ) from error
        self.onnx = onnx
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def constant(self, name: str, values: ArrayLike) -> str:
        """Numbers by name."""
        array = np.ascontiguousarray(values, dtype=np.float32)
        self.constants.append(self.onnx.numpy_helper.from_array(array, name))
        return name

    def integers(self, name: str, values: ArrayLike) -> str:
        """Whole numbers by name, for indices and axes."""
        array = np.ascontiguousarray(values, dtype=np.int64)
        self.constants.append(self.onnx.numpy_helper.from_array(array, name))
        return name

    def add(self, operator: str, *inputs: str, **attributes: Any) -> str:
        """One operator with one result; its name."""
        return self.node(operator, list(inputs), 1, **attributes)[0]

    def node(self, operator: str, inputs: list[str], count: int, **attributes: Any) -> list[str]:
        """One operator with `count` results; their names."""
        name = f"{operator.lower()}_{len(self.nodes)}"
        results = [name if count == 1 else f"{name}_{i}" for i in range(count)]
        self.nodes.append(self.onnx.helper.make_node(operator, inputs, results, name, **attributes))
        return results

    def perceptron(self, value: str, layers: Perceptron) -> str:
        """A network's layers."""
        last = len(layers.weights) - 1
        for i, (weight, bias) in enumerate(zip(layers.weights, layers.biases, strict=True)):
            w, b = self.constant(f"weight_{i}", weight), self.constant(f"bias_{i}", bias)
            value = self.add("Gemm", value, w, b, transB=1)
            value = self.add("Tanh" if i < last else "Sigmoid", value)
        return value

    def finish(
        self, value: str, given: tuple[str, int], found: tuple[str, int], note: str
    ) -> bytes:
        """The file, from what is `given` to `value`, which is called as `found` says."""
        helper, kind = self.onnx.helper, self.onnx.TensorProto.FLOAT
        self.nodes.append(helper.make_node("Identity", [value], [found[0]], "result"))
        graph = helper.make_graph(
            self.nodes,
            "cutis",
            [helper.make_tensor_value_info(given[0], kind, ["n", given[1]])],
            [helper.make_tensor_value_info(found[0], kind, ["n", found[1]])],
            self.constants,
            doc_string=note,
        )
        model = helper.make_model(
            graph,
            opset_imports=[helper.make_opsetid("", OPSET)],
            ir_version=IR_VERSION,
            producer_name="cutis",
        )
        self.onnx.checker.check_model(model)
        return bytes(model.SerializeToString())
