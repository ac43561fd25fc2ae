"""The networks through PyTorch, on a CUDA device where there is one."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutis.errors import CutisError
from cutis.inverse.network import Perceptron

DEVICES = ("cpu", "cuda")


def check_device(device: str) -> None:
    """CutisError when `device` is not one of DEVICES or is not here."""
    if device not in DEVICES:
        raise CutisError(f"unknown device {device!r}; choose {' or '.join(DEVICES)}")
    if device == "cpu":
        return
    try:
        import torch
    except ModuleNotFoundError:
        raise CutisError(
            "--device cuda needs PyTorch built for CUDA; see pytorch.org, or leave the option out"
        ) from None
    if not torch.cuda.is_available():
        raise CutisError("PyTorch finds no CUDA device here; leave --device out to use the CPU")


def torch_network(
    network: Perceptron, device: str
) -> Callable[[NDArray[np.float32]], NDArray[np.float32]]:
    """`network` as a function (n, inputs) → (n, outputs) that PyTorch runs on `device`, float32.

    ModuleNotFoundError without PyTorch.
    """
    import torch
    from torch import nn

    parts: list[Any] = []
    for weight, bias in zip(network.weights, network.biases, strict=True):
        linear = nn.Linear(weight.shape[1], weight.shape[0])
        linear.weight.data = torch.from_numpy(weight.copy())
        linear.bias.data = torch.from_numpy(bias.copy())
        parts += [linear, nn.Tanh()]
    model = nn.Sequential(*parts[:-1], nn.Sigmoid()).eval().to(device)

    def run(values: NDArray[np.float32]) -> NDArray[np.float32]:
        with torch.inference_mode():
            given = torch.from_numpy(np.ascontiguousarray(values)).to(device)
            return np.asarray(model(given).cpu().numpy())

    return run
