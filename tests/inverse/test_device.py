"""The networks through PyTorch agree with the compiled ones; missing devices are named."""

import sys

import numpy as np
import pytest

from cutis.albedo import uniform
from cutis.errors import CutisError
from cutis.inverse.device import check_device, torch_network
from cutis.inverse.shipped import shipped_encoder
from cutis.maps import load_model


def has_cuda():
    torch = pytest.importorskip("torch")
    return torch.cuda.is_available()


def test_pytorch_on_the_processor_agrees():
    pytest.importorskip("torch")
    encoder = shipped_encoder()
    rgb = load_model("aliaga2022").decode(uniform(3000, seed=3))
    np.testing.assert_allclose(torch_network(encoder, "cpu")(rgb), encoder(rgb), atol=1e-5)


def test_cuda_agrees_with_the_processor():
    if not has_cuda():
        pytest.skip("no CUDA device here")
    skins = uniform(3000, seed=4).astype(np.float32)
    here, there = load_model("aliaga2022"), load_model("aliaga2022", "cuda")
    rgb = here.decode(skins)
    np.testing.assert_allclose(there.decode(skins), rgb, atol=1e-5)
    np.testing.assert_allclose(there.encode(rgb), here.encode(rgb), rtol=1e-4, atol=1e-5)


def test_a_device_that_is_not_here_is_refused():
    if has_cuda():
        pytest.skip("there is a CUDA device here")
    with pytest.raises(CutisError, match="finds no CUDA device"):
        load_model("aliaga2022", "cuda")


def test_without_pytorch(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(CutisError, match="needs PyTorch"):
        check_device("cuda")
    check_device("cpu")


def test_unknown_devices_and_models_that_are_tables(monkeypatch):
    with pytest.raises(CutisError, match="unknown device 'gpu'; choose cpu or cuda"):
        load_model("aliaga2022", "gpu")
    monkeypatch.setattr("cutis.inverse.registry.check_device", lambda device: None)
    with pytest.raises(CutisError, match="aliaga2022-exact is a table"):
        load_model("aliaga2022-exact", "cuda")


def test_a_model_runs_on_the_device_it_was_loaded_for(monkeypatch):
    """With a device that PyTorch has everywhere."""
    pytest.importorskip("torch")
    seen = []
    monkeypatch.setattr("cutis.inverse.registry.check_device", lambda device: seen.append(device))
    rgb = np.full((5, 3), 0.4, np.float32)
    here = load_model("aliaga2022").encode(rgb)
    with pytest.raises(NotImplementedError):
        load_model("aliaga2022", "meta").encode(rgb)  # PyTorch's device without memory
    assert seen == ["meta"]
    np.testing.assert_array_equal(load_model("aliaga2022").encode(rgb), here)
