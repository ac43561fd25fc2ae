"""Weights on disk: what is read is what was written, and nothing else is read."""

from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from cutis.albedo import albedo_space, uniform
from cutis.errors import CutisError
from cutis.inverse.network import layer_sizes, load_weights
from cutis.optics import ALIAGA2022, to_coordinates

WEIGHTS = Path(str(resources.files("cutis.data").joinpath("weights/aliaga2022.safetensors")))


def test_layers_are_those_of_the_paper():
    assert layer_sizes(3, 5) == [(3, 70), (70, 70), (70, 70), (70, 5)]


def test_shipped_weights_close_the_loop():
    networks = load_weights(WEIGHTS)
    skins = uniform(2000, 5)
    rgb = albedo_space(ALIAGA2022).rgb(skins)
    decoded = networks.decoder(to_coordinates(skins))
    assert np.abs(decoded - rgb).mean() < 4e-3
    assert np.abs(networks.decoder(networks.encoder(rgb)) - rgb).mean() < 4e-3


def test_shipped_kernel_agrees_with_the_reference():
    networks = load_weights(WEIGHTS)
    rgb = np.random.default_rng(3).random((500, 3), dtype=np.float32)
    u = networks.encoder(rgb)
    np.testing.assert_allclose(u, networks.encoder.reference(rgb), rtol=0, atol=3e-6)
    np.testing.assert_allclose(networks.decoder(u), networks.decoder.reference(u), atol=3e-6)


def test_round_trip(tmp_path):
    networks = load_weights(WEIGHTS)
    tensors = {
        f"{half}.{i}.{kind}": values
        for half in ("encoder", "decoder")
        for kind, arrays in (
            ("weight", getattr(networks, half).weights),
            ("bias", getattr(networks, half).biases),
        )
        for i, values in enumerate(arrays)
    }
    save_file(tensors, tmp_path / "copy.safetensors")
    again = load_weights(tmp_path / "copy.safetensors")
    for half in ("encoder", "decoder"):
        one, two = getattr(networks, half), getattr(again, half)
        for a, b in zip((*one.weights, *one.biases), (*two.weights, *two.biases), strict=True):
            np.testing.assert_array_equal(a, b)


def _truncate(path: Path) -> None:
    path.write_bytes(WEIGHTS.read_bytes()[:5000])


def _noise(path: Path) -> None:
    path.write_bytes(np.random.default_rng(0).bytes(4096))


def _change(path: Path, name: str, values: np.ndarray | None) -> None:
    tensors = load_file(WEIGHTS)
    if values is None:
        del tensors[name]
    else:
        tensors[name] = values.astype(np.float32)
    save_file(tensors, path)


@pytest.mark.parametrize(
    "spoil",
    [
        _truncate,
        _noise,
        lambda path: path.write_bytes(b""),
        lambda path: None,
        lambda path: _change(path, "decoder.2.bias", None),
        lambda path: _change(path, "encoder.1.weight", np.zeros((70, 69))),
        lambda path: _change(path, "encoder.0.bias", np.full(70, np.nan)),
    ],
    ids=["truncated", "noise", "empty", "missing", "no layer", "other size", "NaN"],
)
def test_anything_else_is_refused_in_one_line(spoil, tmp_path):
    path = tmp_path / "bad.safetensors"
    spoil(path)
    with pytest.raises(CutisError, match=r"bad\.safetensors: not a file of encoder") as caught:
        load_weights(path)
    assert "\n" not in str(caught.value)
