"""`cutis simulate`: its tables, how it goes on after it was killed, and a Dask cluster."""

import csv
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from cutis.albedo import grid_skins, halton
from cutis.inverse.lookup import tensor_of_spectra
from cutis.jobs.journal import Journal
from cutis.optics import ALIAGA2022, NAMES, WAVELENGTHS

MAIN = "from cutis.apps.main import main; main()"
QUICK = "import cutis.albedo.simulation as s; s.BATCH_PHOTONS = 200_000\n"
"""Batches so small that there are many of them; also the workers of a cluster must have it."""


def start(*arguments, before=QUICK, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", before + MAIN, *map(str, arguments)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
    )


def wait_for(condition, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.01)
    raise AssertionError("it did not happen in time")


def test_one_skin(cutis, tmp_path):
    out = tmp_path / "skin.csv"
    ended = cutis("simulate", "--melanin", "0.02", "--photons", "2000", "-o", out)
    assert (ended.code, ended.err) == (0, "")
    header, *rows = list(csv.reader(out.read_text().splitlines()))
    assert header == ["wavelength_nm", "reflectance", "standard_error"]
    assert [float(row[0]) for row in rows] == list(WAVELENGTHS)
    assert all(0 < float(row[2]) < 0.02 for row in rows)
    assert "exact solver: rms of z" in ended.out
    assert [path.name for path in tmp_path.iterdir()] == ["skin.csv"]


def test_many_skins_as_arrays_and_as_a_table(cutis, tmp_path):
    (tmp_path / "skins.csv").write_text("melanin,blood\n0.02,0.01\n0.2,0.03\n")
    how = ("--photons", "500", "--dimension", "3", "--boundary", "fresnel", "--incidence", "1")
    for suffix in ("csv", "npz"):
        ended = cutis("simulate", tmp_path / "skins.csv", *how, "-o", tmp_path / f"many.{suffix}")
        assert (ended.code, ended.err) == (0, "")
    header, *rows = list(csv.reader((tmp_path / "many.csv").read_text().splitlines()))
    assert header[:6] == [*NAMES, "380"]
    assert header[46] == "se_380"
    with np.load(tmp_path / "many.npz", allow_pickle=False) as stored:
        table = np.array(rows, dtype=float)
        np.testing.assert_allclose(stored["parameters"], table[:, :5], rtol=1e-7)
        np.testing.assert_allclose(stored["reflectance"], table[:, 5:46], atol=1e-8)
        np.testing.assert_allclose(stored["standard_error"], table[:, 46:], rtol=1e-3)
        assert stored["rgb"].shape == (2, 3)
        notes = json.loads(str(stored["settings"]))
    assert (notes["photons"], notes["seed"], notes["incidence"]) == (500, 0, 1.0)
    assert (notes["tissue"]["dimension"], notes["tissue"]["boundary"]) == (3, "fresnel")


def test_grid_and_dataset(cutis, tmp_path):
    out = tmp_path / "some.npz"
    for flags, skins in (
        (("--grid", "2,1,1,1,2"), grid_skins((2, 1, 1, 1, 2))),
        (("--dataset", "3", "--seed", "5"), halton(3, 5)),
    ):
        ended = cutis("simulate", *flags, "--photons", "50", "-o", out)
        assert (ended.code, ended.err) == (0, "")
        with np.load(out) as stored:
            np.testing.assert_array_equal(stored["parameters"], skins)


def test_a_tensor_for_look_up(cutis, tmp_path):
    out, shape = tmp_path / "tensor.npz", (5, 4, 2, 1, 1)
    ended = cutis("simulate", "--tensor", "5,4,2,1,1", "--photons", "1000", "-o", out, "-q")
    assert (ended.code, ended.out, ended.err) == (0, "", "")
    with np.load(out) as stored:
        tensor = tensor_of_spectra(shape, stored["reflectance"])
        np.testing.assert_array_equal(tensor.nearest(stored["rgb"].astype("f4")), np.arange(40))


def test_killed_and_continued(cutis, tmp_path):
    """SIGKILL after a few batches: what was finished is kept as it was, the result the same."""
    out, arguments = tmp_path / "set.npz", ("--dataset", "24", "--photons", "2000", "--seed", "3")
    process = start("simulate", *arguments, "-o", out)
    parts = tmp_path / "set.npz.parts"
    wait_for(lambda: len(list(parts.glob("[0-9]*.npy"))) >= 3)
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stderr.close()
    done = {path: path.stat().st_mtime_ns for path in parts.glob("[0-9]*.npy")}
    assert 3 <= len(done) < 12
    assert not out.exists()
    (parts / ".000099.abcd.npy").write_bytes(b"half")  # as a kill in the middle of a write leaves
    process = start("simulate", *arguments, "-o", out)
    wait_for(lambda: len(list(parts.glob("[0-9]*.npy"))) > len(done) or out.exists())
    kept = {path: path.stat().st_mtime_ns for path in done if path.exists()}
    assert kept.items() <= done.items()
    assert process.wait(timeout=60) == 0
    process.stderr.close()
    assert not parts.exists()
    plain = tmp_path / "plain.npz"
    assert cutis("simulate", *arguments, "-o", plain).code == 0
    with np.load(out) as continued, np.load(plain) as once:
        for name in ("parameters", "reflectance", "standard_error"):
            np.testing.assert_array_equal(continued[name], once[name])


def test_another_simulation_is_not_mixed_in(tmp_path, cutis):
    from cutis.albedo import SkinSimulation, Walks

    out = tmp_path / "set.csv"
    Journal(SkinSimulation(np.asarray(halton(2, 0)), Walks(ALIAGA2022, photons=10)), out)
    ended = cutis("simulate", "--dataset", "2", "--photons", "20", "-o", out)
    assert ended.code == 1
    assert "set.csv.parts holds a simulation with another photons" in ended.err
    assert cutis("simulate", "--dataset", "2", "--photons", "10", "-o", out).code == 0


def test_a_cluster_that_loses_a_worker(scheduler, worker, cutis, tmp_path):
    """Two workers, one killed midway: no skin is missing or twice, and every bit the same."""
    out, arguments = tmp_path / "set.npz", ("--dataset", "24", "--photons", "2000")
    workers = [worker(QUICK) for _ in range(2)]
    process = start("simulate", *arguments, "--cluster", scheduler, "-o", out)
    try:
        parts = tmp_path / "set.npz.parts"
        wait_for(lambda: len(list(parts.glob("[0-9]*.npy"))) >= 2)
        workers[0].kill()
        said = process.communicate(timeout=90)[1]
        assert process.returncode == 0, said
    finally:
        process.kill()
        process.wait()
    plain = tmp_path / "plain.npz"
    assert cutis("simulate", *arguments, "-o", plain).code == 0
    with np.load(out) as spread, np.load(plain) as once:
        for name in ("parameters", "reflectance", "standard_error", "rgb"):
            np.testing.assert_array_equal(spread[name], once[name])


def test_a_scheduler_that_does_not_answer(cutis, tmp_path, monkeypatch):
    monkeypatch.setattr("cutis.jobs.runners.PATIENCE", 1)
    ended = cutis(
        "simulate", "--photons", "10", "--cluster", "tcp://127.0.0.1:9", "-o", tmp_path / "a.csv"
    )
    assert ended.code == 1
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in ended.err.splitlines()[-1]


@pytest.mark.parametrize(
    ("flags", "what"),
    [
        (("--photons", "0"), "photons = 0"),
        (("--melanin", "7"), "melanin = 7"),
        (("--grid", "2,2"), "5 sizes"),
        (("--grid", "a,b"), "five whole numbers"),
        (("--tensor", "2,2,0,1,1"), "above zero"),
        (("--dataset", "0"), "at least one"),
        (("--dataset", "3", "--grid", "1,1,1,1,1"), "give one of"),
        (("--dimension", "4"), "dimension"),
        (("--boundary", "glass"), "boundary"),
        (("--incidence", "up"), "--incidence"),
        (("--incidence", "0"), "incidence"),
        (("--seed", "-1"), "seed"),
        (("--device", "cuda", "--photons", "1"), "CUDA"),
        (("--cluster", "nonsense"), "no Dask scheduler"),
    ],
)
def test_bad_flags_are_one_line(flags, what, cutis, tmp_path, monkeypatch):
    monkeypatch.setattr("cutis.jobs.runners.PATIENCE", 1)
    ended = cutis("simulate", *flags, "-o", tmp_path / "a.csv")
    assert ended.code == 1
    assert what in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "a.csv").exists()


def test_bad_files_are_one_line(cutis, tmp_path):
    for source, what in (("gone.csv", "no such file"), ("empty.csv", "needs a header")):
        (tmp_path / "empty.csv").write_text("")
        ended = cutis("simulate", tmp_path / source, "-o", tmp_path / "a.csv")
        assert (ended.code, ended.err.count("\n")) == (1, 1)
        assert what in ended.err
    ended = cutis("simulate", "--photons", "10", "-o", tmp_path / "a.txt")
    assert ".csv or .npz" in ended.err


def test_a_damaged_batch_is_named(cutis, tmp_path):
    from cutis.albedo import SkinSimulation, Walks

    out = tmp_path / "set.csv"
    journal = Journal(SkinSimulation(np.asarray(halton(1, 0)), Walks(ALIAGA2022, photons=10)), out)
    (journal.folder / "000000.npy").write_bytes(b"nothing")
    ended = cutis("simulate", "--dataset", "1", "--photons", "10", "-o", out)
    assert ended.code == 1
    assert "000000.npy is damaged" in ended.err
