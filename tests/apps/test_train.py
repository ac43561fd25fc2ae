"""`cutis train` at a small size."""

import json

import pytest


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    """Threads wait long for cores that others keep busy."""
    torch = pytest.importorskip("torch")
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


def test_smoke(cutis, tmp_path, one_line):
    out = tmp_path / "run"
    ended = cutis("train", "smoke", "--epochs", "1", "-o", out)
    assert (ended.code, ended.err) == (0, "")
    assert sorted(path.name for path in out.iterdir()) == [
        "checkpoint.safetensors", "curves.csv", "curves.png", "metrics.json", "weights.safetensors",
    ]  # fmt: skip
    metrics = json.loads((out / "metrics.json").read_text("utf-8"))
    assert metrics["recipe"]["epochs"] == 1
    assert str(metrics["validation"]["decoder_l1"])[:8] in ended.out
    assert "another recipe" in one_line(cutis("train", "smoke", "--epochs", "2", "-o", out))


def test_quiet(cutis, tmp_path):
    ended = cutis("train", "smoke", "--epochs", "1", "-o", tmp_path, "-q")
    assert (ended.code, ended.out, ended.err) == (0, "", "")
