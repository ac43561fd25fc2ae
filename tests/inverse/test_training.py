"""Training end to end at a small size: it learns, goes on after a kill, and keeps runs apart."""

import csv
import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.inverse.network import load_weights
from cutis.optics import ALIAGA2022, NAMES

torch = pytest.importorskip("torch")

from cutis.inverse.training import RECIPES, Recipe, train  # noqa: E402 - needs PyTorch

SMALL = Recipe(name="small", pairs=6000, epochs=12, batch=256, learning_rate=3e-3)
TINY = Recipe(name="tiny", pairs=600, epochs=60, batch=96, learning_rate=1e-3)
"""Long enough to be killed in mid-run."""


@pytest.fixture(autouse=True, scope="module")
def one_thread():
    """Sums come in the same order in every process, and threads do not wait for busy cores."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    seen = []
    metrics = train(SMALL, folder, lambda *state: seen.append(state))
    return folder, metrics, seen


def test_recipe_of_the_paper():
    paper = RECIPES["aliaga2022"]
    assert (paper.pairs, paper.training_share, paper.epochs) == (600_000, 0.8, 400)
    assert (paper.batch, paper.learning_rate, paper.parameter_loss) == (4096, 1e-4, "sum")


def test_it_learns(run):
    _, metrics, seen = run
    assert [state[:2] for state in seen] == [(i + 1, 12) for i in range(12)]
    assert seen[-1][2] < 0.5 * seen[0][2]
    validation = metrics["validation"]
    assert set(validation["parameter_r2"]) == set(NAMES)
    assert validation["parameter_r2"]["melanin"] > 0.9
    assert validation["parameter_r2"]["blood"] > 0.3
    assert validation["decoder_l1"] < 0.03
    assert validation["cycle_l1"] < 0.03


def test_it_writes_what_it_promises(run):
    folder, metrics, _ = run
    names = {"weights.safetensors", "checkpoint.safetensors", "metrics.json", "curves.csv"}
    assert {path.name for path in folder.iterdir()} == names
    assert json.loads((folder / "metrics.json").read_text("utf-8")) == metrics
    with (folder / "curves.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["epoch"]) for row in rows] == list(range(1, 13))
    for column in list(rows[0])[1:]:
        assert float(rows[-1][column]) < float(rows[0][column]), column


def test_weights_are_those_that_were_measured(run):
    from cutis.albedo import albedo_space, uniform
    from cutis.optics import to_coordinates

    folder, metrics, _ = run
    networks = load_weights(folder / "weights.safetensors")
    skins = uniform(1200, SMALL.seed + 1)
    rgb = albedo_space(ALIAGA2022).rgb(skins)
    error = np.abs(networks.decoder(to_coordinates(skins)) - rgb).mean()
    assert error == pytest.approx(metrics["validation"]["decoder_l1"], rel=1e-3)


def test_a_finished_run_is_not_trained_again(run):
    folder, metrics, _ = run
    before = (folder / "weights.safetensors").read_bytes()
    again = train(SMALL, folder, lambda *_: pytest.fail("an epoch was trained"))
    assert (folder / "weights.safetensors").read_bytes() == before
    assert again["validation"] == metrics["validation"]


def test_a_folder_holds_one_recipe(run):
    folder, _, _ = run
    with pytest.raises(CutisError, match="another recipe"):
        train(TINY, folder)


def test_a_killed_run_goes_on_as_if_it_had_not_been(tmp_path):
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    train(TINY, whole)
    code = (
        "import sys, torch\n"
        "from pathlib import Path\n"
        "from cutis.inverse.training import Recipe, train\n"
        "torch.set_num_threads(1)\n"
        f"train({TINY!r}, Path(sys.argv[1]), lambda done, *_: print(done, flush=True))\n"
    )
    with subprocess.Popen([sys.executable, "-c", code, killed], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) == 7:
                os.kill(process.pid, signal.SIGKILL)
                break
    assert process.returncode == -signal.SIGKILL
    assert not (killed / "weights.safetensors").exists()
    epochs = []
    train(TINY, killed, lambda done, *_: epochs.append(done))
    assert 7 <= epochs[0] <= 60
    assert epochs[-1] == 60
    for name in ("weights.safetensors", "curves.csv"):
        assert (killed / name).read_bytes() == (whole / name).read_bytes(), name


def test_a_damaged_checkpoint_is_refused(tmp_path):
    (tmp_path / "checkpoint.safetensors").write_bytes(b"\x08\0\0\0\0\0\0\0nonsense")
    with pytest.raises(CutisError, match="damaged; delete it"):
        train(TINY, tmp_path)
