"""Training of encoder and decoder with PyTorch (extra `train`).

The recipe of the paper is `RECIPES["aliaga2022"]`: squared L2 norm of the error of the five
network coordinates, L1 of the decoder's albedo and of the cycle encoder → decoder (means over the
three channels), all averaged over the batch, and Adam. Initial weights and skins follow from the
seed, the order within an epoch from its number, and checkpoints hold the optimiser, so a run that
was killed goes on as if it had not been.
"""

import csv
import io
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors.torch import load_file, save

from cutis.albedo import albedo_space, halton, uniform
from cutis.errors import CutisError
from cutis.inverse.network import layer_sizes
from cutis.optics import ALIAGA2022, NAMES, to_coordinates


@dataclass(frozen=True)
class Recipe:
    """How to train. `pairs` are split into Halton training and uniform validation skins.

    `parameter_loss` says whether the squared errors of the five coordinates are summed or averaged.
    """

    name: str = "aliaga2022"
    pairs: int = 600_000
    training_share: float = 0.8
    epochs: int = 400
    batch: int = 4096
    learning_rate: float = 1e-4
    parameter_loss: str = "sum"
    seed: int = 2022


RECIPES = {
    "aliaga2022": Recipe(),
    "aliaga2022-mean": Recipe(name="aliaga2022-mean", parameter_loss="mean"),
    "smoke": Recipe(name="smoke", pairs=20_000, epochs=12, batch=512, learning_rate=3e-3),
}
"""The paper's recipe, the same with the parameter loss averaged, and a small one for tests."""

Progress = Callable[[int, int, float], None]
"""Called with (epochs done, epochs, latest training loss)."""


class _Networks(torch.nn.Module):
    """Encoder and decoder under the names that the weights are stored by."""

    def __init__(self) -> None:
        super().__init__()
        self.encoder = _layers(3, 5)
        self.decoder = _layers(5, 3)

    def encode(self, rgb: torch.Tensor) -> torch.Tensor:
        return _forward(self.encoder, rgb)

    def decode(self, coordinates: torch.Tensor) -> torch.Tensor:
        return _forward(self.decoder, coordinates)


def _layers(inputs: int, outputs: int) -> torch.nn.ModuleList:
    return torch.nn.ModuleList(torch.nn.Linear(i, o) for i, o in layer_sizes(inputs, outputs))


def _forward(layers: torch.nn.ModuleList, x: torch.Tensor) -> torch.Tensor:
    for layer in layers[:-1]:
        x = torch.tanh(layer(x))
    return torch.sigmoid(layers[-1](x))


def dataset(recipe: Recipe) -> tuple[tuple[torch.Tensor, torch.Tensor], ...]:
    """Training and validation pairs, each (n, 5) coordinates and (n, 3) linear sRGB."""
    training = round(recipe.pairs * recipe.training_share)
    space = albedo_space(ALIAGA2022)
    sets = []
    for skins in (
        halton(training, recipe.seed),
        uniform(recipe.pairs - training, recipe.seed + 1),
    ):
        u = to_coordinates(skins).astype(np.float32)
        sets.append((torch.from_numpy(u), torch.from_numpy(space.rgb(skins))))
    return tuple(sets)


def train(recipe: Recipe, folder: Path, progress: Progress | None = None) -> dict[str, object]:
    """Trains into `folder`: weights.safetensors, metrics.json, curves.csv; returns the metrics.

    A run found there with the same recipe is continued; one with another recipe raises
    CutisError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(recipe.seed)
    networks = _Networks()
    optimiser = torch.optim.Adam(networks.parameters(), lr=recipe.learning_rate)
    state = _resume(recipe, folder, networks, optimiser)
    (u, rgb), validation = dataset(recipe)
    steps = -(-len(u) // recipe.batch)
    share = 1.0 if recipe.parameter_loss == "sum" else 1.0 / len(NAMES)

    started = time.perf_counter() - float(state["seconds"])
    curves = state["curves"]
    for epoch in range(int(state["epochs"]), recipe.epochs):
        order = torch.randperm(len(u), generator=torch.Generator().manual_seed(epoch))
        running = torch.zeros(())
        for rows in order.split(recipe.batch):
            optimiser.zero_grad(set_to_none=True)
            parameter, albedo, cycle = _losses(networks, u[rows], rgb[rows])
            loss = share * parameter + albedo + cycle
            loss.backward()
            optimiser.step()
            running += loss.detach()
        if (epoch + 1) % max(1, recipe.epochs // 40) == 0 or epoch + 1 == recipe.epochs:
            with torch.no_grad():
                errors = [float(x) for x in _losses(networks, *validation)]
            curves.append(
                {
                    "epoch": epoch + 1,
                    "training_loss": float(running) / steps,
                    "validation_parameter_l2": errors[0],
                    "validation_albedo_l1": errors[1],
                    "validation_cycle_l1": errors[2],
                }
            )
            state["epochs"], state["seconds"] = epoch + 1, time.perf_counter() - started
            _checkpoint(recipe, folder, networks, optimiser, state)
        if progress:
            progress(epoch + 1, recipe.epochs, float(running) / steps)

    metrics = {
        "recipe": asdict(recipe),
        "seconds": round(time.perf_counter() - started, 1),
        "threads": torch.get_num_threads(),
        "validation": evaluate(networks, *validation),
    }
    _write(folder / "curves.csv", _table(curves))
    _write(folder / "weights.safetensors", save(networks.state_dict()))
    _write(folder / "metrics.json", (json.dumps(metrics, indent=2) + "\n").encode())
    return metrics


def evaluate(networks: _Networks, u: torch.Tensor, rgb: torch.Tensor) -> dict[str, object]:
    """Mean squared error and R² per parameter, decoder L1 and cycle L1, over given skins."""
    with torch.no_grad():
        estimate = networks.encode(rgb)
        _, albedo, cycle = _losses(networks, u, rgb)
    error = ((estimate - u) ** 2).mean(0)
    variance = ((u - u.mean(0)) ** 2).mean(0)
    return {
        "parameter_mse": _named(error.numpy()),
        "parameter_r2": _named(1.0 - (error / variance).numpy()),
        "decoder_l1": float(albedo),
        "cycle_l1": float(cycle),
    }


def _named(values: NDArray[np.floating]) -> dict[str, float]:
    return {name: float(value) for name, value in zip(NAMES, values, strict=True)}


def _losses(
    networks: _Networks, u: torch.Tensor, rgb: torch.Tensor
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    estimate = networks.encode(rgb)
    decoded = networks.decode(torch.cat([u, estimate]))
    albedo, cycle = decoded[: len(u)], decoded[len(u) :]
    return (
        ((estimate - u) ** 2).sum(dim=1).mean(),
        (albedo - rgb).abs().mean(),
        (cycle - rgb).abs().mean(),
    )


def _checkpoint(
    recipe: Recipe,
    folder: Path,
    networks: _Networks,
    optimiser: torch.optim.Optimizer,
    state: dict[str, Any],
) -> None:
    tensors = {f"network/{name}": value for name, value in networks.state_dict().items()}
    for i, slots in optimiser.state_dict()["state"].items():
        tensors.update({f"adam/{i}/{name}": value for name, value in slots.items()})
    note = {"state": json.dumps({**state, "recipe": asdict(recipe)})}
    _write(folder / "checkpoint.safetensors", save(tensors, note))
    _write(folder / "curves.csv", _table(state["curves"]))


def _table(curves: list[dict[str, float]]) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, curves[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(curves)
    return text.getvalue().encode()


def _resume(
    recipe: Recipe, folder: Path, networks: _Networks, optimiser: torch.optim.Optimizer
) -> dict[str, Any]:
    """Restores the checkpoint in `folder` if there is one; (epochs, seconds, curves) so far."""
    from safetensors import SafetensorError, safe_open

    path = folder / "checkpoint.safetensors"
    if not path.exists():
        return {"epochs": 0, "seconds": 0.0, "curves": []}
    try:
        with safe_open(path, "pt") as file:
            state: dict[str, Any] = json.loads(file.metadata()["state"])
        tensors = load_file(path)
    except (SafetensorError, ValueError, KeyError, TypeError) as error:
        raise CutisError(f"{path} is damaged; delete it to start again") from error
    if state.pop("recipe") != asdict(recipe):
        raise CutisError(f"{folder} holds a run of another recipe; give another folder with -o")
    networks.load_state_dict(
        {k.removeprefix("network/"): v for k, v in tensors.items() if k.startswith("network/")}
    )
    slots: dict[int, dict[str, torch.Tensor]] = {}
    for key, value in tensors.items():
        if key.startswith("adam/"):
            _, i, name = key.split("/")
            slots.setdefault(int(i), {})[name] = value
    adam = optimiser.state_dict()
    optimiser.load_state_dict({"state": slots, "param_groups": adam["param_groups"]})
    return state


def _write(path: Path, content: bytes) -> None:
    """Writes beside `path` and renames, so that a killed run leaves no half file."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        raise CutisError(f"{path}: cannot be written ({error.strerror})") from error
    finally:
        partial.unlink(missing_ok=True)
