"""Many textures: folders, sets, second runs, processes, kills."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import cutis as package
from cutis.colour import LINEAR
from cutis.maps import load_maps
from cutis.textures import Texture, read_channels, write_texture

MAIN = "from cutis.apps.main import main; main()"


def written(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def show(face_rgb, tmp_path):
    """A folder with three captures that differ, one that is none, and what is no image."""
    folder = tmp_path / "show"
    folder.mkdir()
    for i, name in enumerate(("a", "b", "c")):
        pixels = np.roll(face_rgb, 5 * i, axis=1).astype(np.float32) * np.float32(1 - 0.1 * i)
        write_texture(Texture(pixels, ("R", "G", "B"), LINEAR), folder / f"{name}.exr")
    (folder / "bad.exr").write_bytes(b"v/1\x01junk")
    (folder / "notes.txt").write_text("not an image")
    return folder


@pytest.fixture
def tiles(face_rgb, tmp_path):
    folder = tmp_path / "set"
    folder.mkdir()
    for i, number in enumerate((1001, 1002, 1011)):
        pixels = face_rgb[:, i * 8 : i * 8 + 16].astype(np.float16)
        write_texture(Texture(pixels, ("R", "G", "B"), LINEAR), folder / f"face.{number}.exr")
    return folder / "face.<UDIM>.exr"


@pytest.mark.parametrize("how", [(), ("--jobs", "2")], ids=["here", "processes"])
def test_a_bad_file_fails_alone(show, cutis, tmp_path, how):
    out = tmp_path / "out"
    ended = cutis("estimate", show, "*.exr", "-o", out, *how)
    assert ended.code == 1
    assert ended.err.count("\n") == 1
    assert "1 of 4 failed" in ended.err
    assert "bad.exr" in ended.err
    assert "3 of 4 estimated" in ended.out
    for name in "abc":
        expected = package.estimate(package.read(show / f"{name}.exr"))
        stored = load_maps(out / f"{name}.skin.exr")
        np.testing.assert_array_equal(stored.parameters(), expected.parameters())
    assert not any("bad" in name for name in written(out))


def test_a_second_run_does_what_is_missing_or_changed(show, cutis, tmp_path):
    out = tmp_path / "out"
    (show / "bad.exr").unlink()
    assert cutis("estimate", show, "-o", out, "-q").code == 0
    before = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}
    ended = cutis("estimate", show, "-o", out)
    assert "3 were there already" in ended.out
    assert {path.name: path.stat().st_mtime_ns for path in out.iterdir()} == before

    (out / "b.skin.exr").unlink()
    (show / "c.exr").write_bytes((show / "a.exr").read_bytes())
    ended = cutis("estimate", show, "-o", out)
    assert "2 of 3 estimated" in ended.out
    assert "1 were there already" in ended.out
    same = [load_maps(out / f"{name}.skin.exr").parameters() for name in "ac"]
    np.testing.assert_array_equal(*same)
    after = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}
    assert {name for name in after if after[name] == before[name]} == {
        name for name in before if name.startswith("a.")
    }

    refused = cutis("estimate", show, "-o", out, "--half")
    assert refused.code == 1
    assert "made with other flags (--half)" in refused.err
    assert {path.name: path.stat().st_mtime_ns for path in out.iterdir()} == after
    assert "3 of 3 estimated" in cutis("estimate", show, "-o", out, "--half", "--again").out


def test_one_calibration_for_a_sequence(show, cutis, tmp_path):
    out = tmp_path / "out"
    (show / "bad.exr").unlink()
    for flags, different in (((), 3), (("--sequence",), 1)):
        assert cutis("estimate", show, "-o", out, "--exposure", "auto", "-q", *flags).code == 0
        found = [load_maps(out / f"{name}.skin.exr").calibration.gains for name in "abc"]
        assert len(set(found)) == different


def test_udim_sets(tiles, cutis, tmp_path):
    """By pattern, by one tile, by folder: the same gains for all tiles, the same files."""
    gains = {}
    words = {"pattern": (tiles,), "tile": (tiles.with_name("face.1002.exr"), "--udim"),
             "folder": (tiles.parent,)}  # fmt: skip
    for kind, arguments in words.items():
        out = tmp_path / kind
        ended = cutis("estimate", *arguments, "-o", out, "--exposure", "auto")
        assert ended.code == 0, ended.err
        found = {n: load_maps(out / f"face.{n}.skin.exr").calibration for n in (1001, 1002, 1011)}
        assert len(set(found.values())) == 1
        gains[kind] = found[1001]
    assert len(set(gains.values())) == 1
    ended = cutis(
        "edit", tmp_path / "folder" / "face.<UDIM>.skin.exr", "--melanin", "x2",
        "-o", tmp_path / "tan.<UDIM>.exr",
    )  # fmt: skip
    assert ended.code == 0, ended.err
    for number in (1001, 1002, 1011):
        before = package.read(tiles.with_name(f"face.{number}.exr"))
        skin = package.load(tmp_path / "folder" / f"face.{number}.skin.exr")
        expected = skin.multiply(melanin=2).retouch(before).pixels
        np.testing.assert_array_equal(package.read(tmp_path / f"tan.{number}.exr").pixels, expected)


def test_tiles_missing_and_odd_are_named(tiles, cutis, tmp_path):
    tiles.with_name("face.1002.exr").rename(tiles.with_name("face.1004.exr"))
    ended = cutis("estimate", tiles, "-o", tmp_path / "out")
    assert ended.code == 0
    assert "face.1002.exr is missing" in ended.out
    assert "face.1003.exr is missing" in ended.out
    tiles.with_name("face.1004.exr").rename(tiles.with_name("face.10004.exr"))
    ended = cutis("estimate", tiles, "-o", tmp_path / "out")
    assert ended.code == 1
    assert "face.10004.exr" in ended.err


@pytest.mark.parametrize("name", ["face.<UDIM>.png", "gone/face.<UDIM>.exr"])
def test_sets_that_are_not_there(name, tmp_path, cutis, one_line):
    line = one_line(cutis("estimate", tmp_path / name, "-o", tmp_path / "out"))
    assert "check the name" in line


def test_two_captures_of_one_name(show, cutis, tmp_path, one_line):
    other = tmp_path / "a.exr"
    other.write_bytes((show / "a.exr").read_bytes())
    line = one_line(cutis("estimate", show / "a.exr", other, "-o", tmp_path / "out"))
    assert "overwrite each other" in line


def test_results_beside_captures_are_not_captures(show, cutis):
    (show / "bad.exr").unlink()
    assert cutis("estimate", show, "-o", show, "-q").code == 0
    first = written(show)
    ended = cutis("estimate", show, "-o", show)
    assert "0 of 3 estimated" in ended.out
    assert written(show) == first


@pytest.mark.slow
@pytest.mark.parametrize("kills", [2, pytest.param(6, marks=pytest.mark.long)])
def test_kills_lose_nothing(kills, tiles, tmp_path, process):
    """kill -9 at random moments: what is there is whole, and the next run completes the set."""
    out = tmp_path / "out"
    arguments = ["estimate", str(tiles), "-o", str(out), "--exposure", "auto", "--quiet"]
    dice = random.Random(1)
    begin = time.monotonic()
    assert process(*arguments).code == 0
    usual = time.monotonic() - begin
    expected = {path.name: path.read_bytes() for path in out.glob("*.report.json")}
    whole = written(out)
    for path in out.iterdir():
        path.unlink()
    for _ in range(kills):
        with subprocess.Popen([sys.executable, "-c", MAIN, *arguments], env={**os.environ}) as run:
            time.sleep(dice.uniform(0.3, 1) * usual)
            run.send_signal(signal.SIGKILL)
        for path in [p for p in out.glob("*") if not p.name.startswith(".")]:
            if path.suffix == ".exr":
                read_channels(path)
            elif path.suffix == ".json":
                json.loads(path.read_text("utf-8"))
            else:
                assert path.read_bytes().endswith(b"\xaeB`\x82")  # the end of a PNG
    assert process(*arguments).code == 0
    assert written(out) == whole
    assert {path.name: path.read_bytes() for path in out.glob("*.report.json")} == expected


def test_a_cluster_that_loses_a_worker(show, scheduler, worker, cutis, tmp_path):
    """Two workers, one killed after the first result: all are there, and as without a cluster."""
    (show / "bad.exr").unlink()
    out, here = tmp_path / "out", tmp_path / "here"
    workers = [worker() for _ in range(2)]
    arguments = ["estimate", str(show), "--exposure", "auto", "--sequence", "--quiet"]
    with subprocess.Popen(
        [sys.executable, "-c", MAIN, *arguments, "-o", str(out), "--cluster", scheduler],
        stderr=subprocess.PIPE, text=True,
    ) as run:  # fmt: skip
        end = time.monotonic() + 90
        while not list(out.glob("*.report.json")) and run.poll() is None:
            assert time.monotonic() < end
            time.sleep(0.01)
        workers[0].kill()
        said = run.communicate(timeout=90)[1]
    assert run.returncode == 0, said
    assert cutis(*arguments, "-o", here).code == 0
    # what the killed worker was writing lies there under hidden names until the next run
    assert [name for name in written(out) if not name.startswith(".")] == written(here)
    for name in "abc":
        spread, alone = (load_maps(folder / f"{name}.skin.exr") for folder in (out, here))
        np.testing.assert_array_equal(spread.parameters(), alone.parameters())
