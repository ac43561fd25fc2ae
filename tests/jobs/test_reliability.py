"""Work that is lost, mixed or stale: none of it counts as done."""

import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cutis.errors import CutisError
from cutis.jobs import CaptureFiles, EstimateJob
from cutis.jobs.results import alone
from cutis.maps import load_maps
from cutis.report.previews import Previews
from cutis.textures import read_texture

MAIN = "from cutis.apps.main import main; main()"


def command(*arguments, **options):
    return subprocess.Popen(
        [sys.executable, "-c", MAIN, *map(str, arguments)],
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options,
    )  # fmt: skip


def children(pid: int) -> set[int]:
    """Processes below one, on Linux."""
    found = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found |= {int(stat.parent.name)} | children(int(stat.parent.name))
    return found


def alive(pids: set[int]) -> set[int]:
    there = set()
    for pid in pids:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            continue
        if state != "Z":
            there.add(pid)
    return there


@pytest.fixture
def many(write_face, tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    for name in "abcdefgh":
        write_face(folder, "png8", name=name)
    return folder


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_workers_end_with_their_parent(how, many, tmp_path):
    out = tmp_path / "out"
    run = command("estimate", many, "--jobs", 2, "-o", out, "-q")
    end = time.monotonic() + 100
    while not list(out.glob("*.skin.exr")) and time.monotonic() < end:
        time.sleep(0.02)
    below = children(run.pid)
    assert below
    run.send_signal(how)
    run.communicate(timeout=60)
    if how != signal.SIGKILL:
        assert run.returncode == 128 + how
    end = time.monotonic() + 5
    while alive(below) and time.monotonic() < end:
        time.sleep(0.05)
    assert not alive(below)
    before = sorted(path.name for path in out.iterdir())
    time.sleep(0.5)
    assert sorted(path.name for path in out.iterdir()) == before
    again = command("estimate", many, "-o", out)
    said, errors = again.communicate(timeout=200)
    assert again.returncode == 0, errors
    assert "8 estimated" in said or "of 8 estimated" in said
    left = [p.name for p in out.iterdir() if p.name.startswith(".")]
    assert not left


def test_a_result_that_failed_midway_is_not_done(many, cutis, tmp_path, monkeypatch):
    out = tmp_path / "out"
    for path in many.iterdir():
        if path.name not in ("a.png", "b.png"):
            path.unlink()
    assert cutis("estimate", many, "-o", out, "-q").code == 0
    write = Previews.write

    def full(self, stem):
        if stem.name == "a":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), f"{stem}.sigma.png")
        return write(self, stem)

    with monkeypatch.context() as patch:
        patch.setattr(Previews, "write", full)
        ended = cutis("estimate", many, "-o", out, "--exposure", "2", "--again", "-q")
    assert ended.code == 1
    assert "a.sigma.png" in ended.err
    assert not (out / "a.report.json").exists()
    ended = cutis("estimate", many, "-o", out, "--exposure", "2")
    assert ended.code == 0
    assert "1 of 2 estimated" in ended.out
    assert "1 were there already" in ended.out
    for name in "ab":
        assert load_maps(out / f"{name}.skin.exr").calibration.gains == (2.0, 2.0, 2.0)


def test_every_file_of_a_result_counts(many, cutis, tmp_path):
    out = tmp_path / "out"
    assert cutis("estimate", many / "a.png", "-o", out, "-q").code == 0
    (out / "a.sigma.png").unlink()
    assert "wrote" in cutis("estimate", many / "a.png", "-o", out).out
    assert (out / "a.sigma.png").is_file()
    assert "was there already" in cutis("estimate", many / "a.png", "-o", out).out


@pytest.mark.parametrize("what", ["lamp", "mask", "capture", "weights"])
def test_changed_content_is_done_again_and_said(what, many, cutis, tmp_path, face_mask):
    lamp, mask, out = tmp_path / "lamp.csv", tmp_path / "mask.png", tmp_path / "out"
    weights = tmp_path / "w.safetensors"
    shutil.copy(
        Path(__file__).parents[2] / "src/cutis/data/weights/aliaga2022.safetensors", weights
    )

    def light(slope):
        rows = (f"{lam},{1 + slope * (lam - 380) / 400}" for lam in range(380, 781, 10))
        lamp.write_text("wavelength_nm,power\n" + "\n".join(rows) + "\n", encoding="utf-8")

    light(0.1)
    shutil.copy(many / "a.png", mask)
    flags = {
        "lamp": ("--illuminant", lamp), "mask": ("--mask", mask), "capture": (),
        "weights": ("--model", weights),
    }[what]  # fmt: skip
    call = ("estimate", many / "a.png", "-o", out, *flags)
    assert cutis(*call, "-q").code == 0
    assert "was there already" in cutis(*call).out
    if what == "lamp":
        light(0.9)
    elif what == "mask":
        texture = read_texture(mask)
        pixels = texture.pixels.copy()
        pixels[:4] = 0
        from dataclasses import replace

        from cutis.textures import write_texture

        write_texture(replace(texture, pixels=pixels), mask)
    elif what == "capture":
        from PIL import Image

        with Image.open(many / "a.png") as picture:
            darker = picture.point(lambda v: int(v * 0.9))
        darker.save(many / "a.png")
    else:
        from safetensors.numpy import load_file, save_file

        tensors = load_file(weights)
        tensors["encoder.3.bias"] = tensors["encoder.3.bias"] + np.float32(0.1)
        save_file(tensors, weights)
    before = (out / "a.skin.exr").read_bytes()
    named = {"lamp": "light", "mask": "mask", "capture": "capture", "weights": "model"}[what]
    ended = cutis(*call)
    assert ended.code == 0, ended.err
    assert f"made again, {named} changed" in ended.out
    assert (out / "a.skin.exr").read_bytes() != before


def test_other_flags_need_a_word(many, cutis, tmp_path, one_line):
    """The README's tour once replaced good maps by others of the same face."""
    out = tmp_path / "out"
    assert cutis("estimate", many / "a.png", "--white", "auto", "-o", out, "-q").code == 0
    before = (out / "a.skin.exr").read_bytes()
    line = one_line(cutis("estimate", many / "a.png", "-o", out))
    assert "made with other flags (--white)" in line
    assert (out / "a.skin.exr").read_bytes() == before
    assert cutis("estimate", many / "a.png", "-o", out, "--again", "-q").code == 0
    assert (out / "a.skin.exr").read_bytes() != before


def test_reports_that_are_none(many, cutis, tmp_path):
    """One bad sidecar ends nothing for the others."""
    out = tmp_path / "out"
    out.mkdir()
    bad = ("[]", "null", "1", '"x"', '{"made_from": [], "files": 3}', "{" * 100_000, "\xff")
    for name, text in zip("abcdefg", bad, strict=True):
        (out / f"{name}.report.json").write_text(text, encoding="latin-1")
    ended = cutis("estimate", many, "-o", out)
    assert ended.code == 1
    assert "1 of 8 estimated" in ended.out
    assert ended.err.count("--again") == 7
    assert cutis("estimate", many, "-o", out, "--again", "-q").code == 0


def test_two_writers_do_not_mix(many, tmp_path):
    """The second is told so at once, or finds the work of the first done."""
    out = tmp_path / "out"
    out.mkdir()
    raises = pytest.raises(CutisError, match="another run is writing")
    with alone(out / "a"), raises, alone(out / "a"):
        pass
    with alone(out / "a"):
        pass
    assert not list(out.iterdir())
    runs = [
        command("estimate", many / "a.png", "--exposure", gain, "-o", out, "-q") for gain in (1, 2)
    ]
    ends = [(*run.communicate(timeout=120), run.returncode) for run in runs]
    assert sorted(code for *_, code in ends) in ([0, 1], [0, 0])
    gain = load_maps(out / "a.skin.exr").calibration.gains[0]
    import json

    report = json.loads((out / "a.report.json").read_text("utf-8"))
    assert report["calibration"]["gains"] == [gain] * 3
    for _, errors, code in ends:
        assert code == 0 or "another run is writing" in errors or "other flags" in errors


def test_a_lock_goes_with_its_process(tmp_path):
    script = (
        "import sys, time\nfrom pathlib import Path\nfrom cutis.jobs.results import alone\n"
        "with alone(Path(sys.argv[1])):\n    print('held', flush=True)\n    time.sleep(60)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path / "a")], stdout=subprocess.PIPE, text=True
    ) as held:
        assert held.stdout is not None
        assert held.stdout.readline() == "held\n"
        with pytest.raises(CutisError, match="another run"), alone(tmp_path / "a"):
            pass
        held.kill()
        held.wait()
    with alone(tmp_path / "a"):
        pass


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("render", "in/a.png", "--mesh", "patch", "-o", "in/a.png"), "the skin to render"),
        (("edit", "o/a.skin.exr", "--melanin", "x2", "--mask", "m.png", "-o", "m.png"), "mask"),
        (("estimate", "e/a.png", "e/a.model.exr", "-o", "e"), "the capture a.model.exr"),
        (("export", "o/x.cube", "--melanin", "x2", "--maps", "o/x.cube"), "the file of maps"),
        (("spectrum", "skins.csv", "-o", "skins.csv"), "the CSV of skins"),
    ],
)
def test_outputs_are_no_inputs(arguments, what, many, cutis, tmp_path, monkeypatch, one_line):
    monkeypatch.chdir(tmp_path)
    assert cutis("estimate", "in/a.png", "-o", "o", "-q").code == 0
    shutil.copy("in/a.png", "m.png")
    shutil.copy("o/a.skin.exr", "o/x.cube")
    Path("e").mkdir()
    shutil.copy("in/a.png", "e/a.png")
    shutil.copy("o/a.model.exr", "e/a.model.exr")
    Path("skins.csv").write_text("melanin\n0.02\n", encoding="utf-8")
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    line = one_line(cutis(*arguments))
    assert f"is {what} itself" in line.replace("the mask", "mask")
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


def test_names_that_are_too_long_are_found_first(many, cutis, tmp_path, one_line):
    long = many / f"{'x' * 244}.png"
    shutil.copy(many / "a.png", long)
    out = tmp_path / "out"
    assert "its name is longer than" in one_line(cutis("estimate", long, "-o", out))
    assert not out.exists()


def test_a_worker_elsewhere_writes_where_it_was_told(
    many, scheduler, worker, cutis, tmp_path, monkeypatch
):
    """Relative names mean those of whoever typed them, not of the worker's folder."""
    other = tmp_path / "worker"
    (other / "in").mkdir(parents=True)
    from PIL import Image

    Image.new("RGB", (32, 24), (90, 60, 50)).save(other / "in" / "a.png")
    monkeypatch.chdir(other)
    worker()
    monkeypatch.chdir(tmp_path)
    ended = cutis("estimate", "in/a.png", "--cluster", scheduler, "-o", "out", "-q")
    assert (ended.code, ended.err) == (0, "")
    assert not (other / "out").exists()
    EstimateJob((CaptureFiles(Path("in/a.png")),), Path("here")).run()
    spread, here = (load_maps(f"{folder}/a.skin.exr") for folder in ("out", "here"))
    np.testing.assert_array_equal(spread.parameters(), here.parameters())


def test_a_scheduler_that_goes_away_is_said(many, scheduler, worker, tmp_path, request):
    worker()
    out = tmp_path / "out"
    run = command("estimate", many, "--cluster", scheduler, "-o", out)
    end = time.monotonic() + 100
    while not list(out.glob("*.report.json")) and run.poll() is None:
        assert time.monotonic() < end
        time.sleep(0.02)
    request.getfixturevalue("scheduler_process").kill()
    said, errors = run.communicate(timeout=120)
    done = len(list(out.glob("*.report.json")))
    if done < 8 or run.returncode:
        assert run.returncode == 1, (said, errors)
        assert "went away" in errors
        assert len(errors.strip().splitlines()) == 1, errors


def test_what_files_say_does_not_direct_the_terminal(maps, cutis):
    """Names, notes and edits of a stranger's maps are shown as codes."""
    from cutis.textures import read_channels, write_channels

    channels, header = read_channels(maps)
    evil = "\x1b]0;owned\x07\x1b]52;c;b3du\x1b\\"
    header["cutis:evil\x1b[2J"] = evil
    header["cutis:model"] = evil
    header["cutis:calibration"] = '{"gains": [1, 1, 1], "origin": "\\u001b]0;x\\u0007"}'
    write_channels(maps, channels, metadata=header)
    ended = cutis("info", maps)
    assert "\x1b" not in ended.out + ended.err
    assert "\x07" not in ended.out + ended.err
