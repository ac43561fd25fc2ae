"""Ends commands at random moments by KILL, TERM and HUP, and looks at what they leave.

    python -m studies.kill_runs --kills 200 --pairs 100
    python -m studies.kill_runs --kills 20 --only estimate --only edit

Every command that writes files is tried on small inputs: here, in processes (--jobs), on a cluster.
A file under its final name must be, byte by byte, that of a run that nobody ended: else it is
broken or mixed. Processes that a command started must end with it. After one more run, undisturbed,
nothing may be missing, differ, or be left over, in the folder of results and in that of temporary
files. Then pairs of runs with different flags write the same results at once: what is there
afterwards must be all of one of them. Findings: docs/batch.md.
"""

import argparse
import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

MAIN = (sys.executable, "-c", "from cutis.apps.main import main; main()")
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP)
SETTLE = 5.0
"""Seconds in which processes below one that was ended must end."""
Files = dict[str, bytes]


@dataclass(frozen=True)
class Trial:
    """A command that writes into `out/`, and its other flags for the second of a pair."""

    name: str
    arguments: tuple[str, ...]
    other: tuple[str, ...] = ()


def trials(cluster: str | None, blender: bool) -> list[Trial]:
    """All commands that write files."""
    skin = "maps/a.skin.exr"
    found = [
        Trial("estimate", ("estimate", "in", "-o", "out"), ("--exposure", "1.3")),
        Trial("jobs", ("estimate", "in", "--jobs", "2", "--report", "-o", "out"),
              ("--exposure", "1.3")),
        Trial("edit", ("edit", skin, "--melanin", "x1.4", "--save-maps", "out/e.skin.exr", "-o",
                       "out/e.png"), ("--blood", "x2")),
        Trial("export", ("export", "out/look.cube", "--melanin", "x2", "--size", "17"),
              ("--blood", "x2")),
        Trial("fit", ("fit", "spectra.csv", "-o", "out/fit.csv"), ("--specular", "0.028")),
        Trial("cube", ("fit", "cube.npy", "--wavelengths", "bands.txt", "-o",
                       "out/cube.skin.exr"), ("--specular", "0.028")),
        Trial("spectrum", ("spectrum", "--melanin", "0.02", "-o", "out/s.csv"),
              ("--blood", "0.05")),
        Trial("simulate", ("simulate", "--melanin", "0.02", "--photons", "200000", "-o",
                           "out/m.csv"), ("--seed", "5")),
    ]  # fmt: skip
    if cluster:
        found.append(Trial("cluster", ("estimate", "in", "--cluster", cluster, "-o", "out"),
                           ("--exposure", "1.3")))  # fmt: skip
    if blender:
        found.append(Trial("render", ("render", skin, "--size", "32", "--samples", "64",
                                      "--no-denoise", "--device", "cpu", "--turntable", "3", "-o",
                                      "out/turn.png")))  # fmt: skip
    return found


def prepare(folder: Path) -> None:
    """The inputs of all commands."""
    from cutis.albedo import albedo_space
    from cutis.colour import SRGB
    from cutis.optics import MEASURED2026, WAVELENGTHS
    from cutis.textures import Texture, write_texture

    space, y = albedo_space(MEASURED2026), np.linspace(0, 1, 96)
    (folder / "in").mkdir()
    for number, name in enumerate("abcd"):
        shares = np.broadcast_to(y[:, None], (96, 96)), np.broadcast_to(y, (96, 96))
        skins = np.stack(
            [0.02 + 0.02 * number + 0.02 * shares[0], 0.01 + 0.02 * shares[1],
             70 + 20 * shares[0], np.full((96, 96), 0.5), np.full((96, 96), 0.7)], -1,
        )  # fmt: skip
        codes = np.rint(255 * np.clip(SRGB.from_linear_srgb(space.rgb(skins)), 0, 1)).astype(
            np.uint8
        )
        write_texture(Texture(codes, ("R", "G", "B"), SRGB), folder / "in" / f"{name}.png")
    spectra = space.reflectance(skins.reshape(-1, 5)[:: 96 * 4])[:, 2:33]
    bands = WAVELENGTHS[2:33]
    rows = [",".join(["site", *(f"{lam:g}" for lam in bands)])]
    rows += [",".join([f"s{i}", *(f"{v:.6f}" for v in values)]) for i, values in enumerate(spectra)]
    (folder / "spectra.csv").write_text("\n".join(rows) + "\n")
    cube = space.reflectance(skins[::6, ::6].reshape(-1, 5))[:, 2:33].reshape(16, 16, -1)
    np.save(folder / "cube.npy", cube.astype(np.float32))
    (folder / "bands.txt").write_text("\n".join(f"{lam:g}" for lam in bands) + "\n")
    subprocess.run([*MAIN, "estimate", "in/a.png", "-o", "maps", "-q"], cwd=folder, check=True)


def files(folder: Path, hidden: bool = False) -> Files:
    """All files below a folder by name; those under hidden names only if asked for."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and (hidden or not path.name.startswith("."))
    }


def below(pid: int) -> set[int]:
    """Processes that a process started, and theirs."""
    found: set[int] = set()
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            for child in map(int, task.read_text().split()):
                found |= {child} | below(child)
    return found


def living(pids: set[int]) -> set[int]:
    """Those that still run."""
    there = set()
    for pid in pids:
        with contextlib.suppress(OSError):
            if Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z":
                there.add(pid)
    return there


class Place:
    """A folder to run one command in again and again."""

    def __init__(self, folder: Path, trial: Trial) -> None:
        self.folder, self.trial, self.out = folder, trial, folder / "out"
        self.temporary = folder / "tmp"
        self.environment = {
            **os.environ,
            "TMPDIR": str(self.temporary),
            "OPENBLAS_NUM_THREADS": "1",
        }
        self.clear()
        self.run()  # compiles what is not compiled yet
        self.clear()
        begin = time.monotonic()
        self.run()
        self.usual = time.monotonic() - begin
        self.good = files(self.out)

    def clear(self) -> None:
        """No results, no temporary files."""
        for path in (self.out, self.temporary):
            shutil.rmtree(path, ignore_errors=True)
            path.mkdir()

    def start(self, *more: str) -> subprocess.Popen[str]:
        """The command, running."""
        return subprocess.Popen(
            [*MAIN, *self.trial.arguments, *more], cwd=self.folder, env=self.environment, text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        )  # fmt: skip

    def run(self, *more: str) -> None:
        """The command, to its end."""
        with self.start(*more) as process:
            _, said = process.communicate(timeout=600)
        if process.returncode:
            raise SystemExit(f"{self.trial.name}: {said}")

    def kill(self, moment: float, how: signal.Signals) -> Counter[str]:
        """Ends the command at a share of its usual time; returns what is wrong then."""
        found: Counter[str] = Counter()
        process = self.start()
        time.sleep(moment * self.usual)
        started = below(process.pid)
        process.send_signal(how)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.communicate(timeout=60)
        if process.poll() is None:
            process.kill()
            process.communicate()
            found["not ended"] += 1
        if process.returncode not in (0, -how, 128 + how):
            found[f"exit {process.returncode}"] += 1
        end = time.monotonic() + SETTLE
        while living(started) and time.monotonic() < end:
            time.sleep(0.05)
        found["orphaned"] += len(living(started))
        for pid in living(started):
            os.kill(pid, signal.SIGKILL)
        for name, content in files(self.out).items():
            if ".parts/" not in name and not name.endswith("frames.json"):
                found["broken or mixed"] += content != self.good.get(name)
        if how != signal.SIGKILL and process.returncode > 128:
            found["left by a soft end"] += len(list(self.temporary.iterdir()))
        return +found

    def finish(self) -> Counter[str]:
        """One more run, undisturbed; what is wrong after it."""
        found: Counter[str] = Counter()
        time.sleep(1.5)  # temporary files younger than a second are left alone
        self.run()
        now = files(self.out, hidden=True)
        found["missing"] = len(self.good.keys() - now.keys())
        found["left over"] = len(now.keys() - self.good.keys()) + len(
            list(self.temporary.iterdir())
        )
        found["differ"] = sum(now[n] != self.good[n] for n in self.good.keys() & now.keys())
        return +found

    def pair(self, others: Files) -> Counter[str]:
        """Two runs at once with different flags; what is wrong after them."""
        self.clear()
        runs = [self.start(), self.start(*self.trial.other)]
        said = [run.communicate(timeout=600)[1] for run in runs]
        found: Counter[str] = Counter()
        codes = [run.returncode for run in runs]
        found[f"neither wrote: {said[0][:200]}"] += not (0 in codes or files(self.out))
        found["not in one line"] += any(
            code not in (0, 1) or text.count("\n") > 1
            for code, text in zip(codes, said, strict=True)
        )
        now = files(self.out)
        sets = {name.split(".")[0] for name in now} if "in" in self.trial.arguments else {""}
        for stem in sets:
            some = {name: data for name, data in now.items() if name.startswith(stem)}
            found["mixed"] += not any(
                all(one.get(name) == data for name, data in some.items())
                for one in (self.good, others)
            )
        found["left over"] += len(files(self.out, hidden=True)) - len(now)
        return +found


@contextlib.contextmanager
def dask(folder: Path) -> Iterator[str]:
    """The address of a scheduler with two workers."""
    import socket

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    program = [sys.executable, "-m", "distributed.cli"]
    local = ["--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0"]
    commands = [[*program[:2], "distributed.cli.dask_scheduler", *local, "--port",
                 address.rpartition(":")[2]]]  # fmt: skip
    commands.append([*program[:2], "distributed.cli.dask_worker", address, *local, "--nthreads",
                     "1", "--nworkers", "2"])  # fmt: skip
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    held = [subprocess.Popen(one, cwd=folder, **quiet) for one in commands]  # type: ignore[call-overload]
    try:
        time.sleep(15)
        yield address
    finally:
        for one in reversed(held):
            one.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                one.wait(20)
            one.kill()


def main() -> None:
    """Exit code 1 where anything was found."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=200, help="over all commands")
    parser.add_argument("--pairs", type=int, default=100, help="over all commands")
    parser.add_argument("--only", action="append", help="names of trials")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    dice, total, kills, pairs = random.Random(options.seed), Counter[str](), 0, 0
    from cutis.errors import CutisError
    from cutis.render import find_blender

    try:
        blender = bool(find_blender())
    except CutisError:
        blender = False
    with tempfile.TemporaryDirectory() as name, contextlib.ExitStack() as stack:
        folder = Path(name)
        prepare(folder)
        wanted = options.only or ["cluster"]
        address = stack.enter_context(dask(folder)) if "cluster" in wanted else None
        chosen = [t for t in trials(address, blender) if not options.only or t.name in options.only]
        for number, trial in enumerate(chosen):
            place, found = Place(folder, trial), Counter[str]()
            count = options.kills * (number + 1) // len(chosen) - kills
            for turn in range(count):
                how = SIGNALS[turn % len(SIGNALS)]
                found += place.kill(dice.uniform(0.1, 1.0), how)
                if files(place.out).keys() >= place.good.keys() or turn % 5 == 4:
                    found += place.finish()
                    place.clear()
            found += place.finish()
            kills += count
            many = options.pairs * (number + 1) // len(chosen) - pairs
            pairs += many
            if trial.other and many:
                place.clear()
                place.run(*trial.other)
                others = files(place.out)
                for _ in range(many):
                    found += place.pair(others)
            print(f"{trial.name}: {place.usual:.1f} s, {count} kills, {many} pairs: "
                  f"{dict(found) or 'nothing found'}", flush=True)  # fmt: skip
            total += found
    print(f"{kills} kills, {pairs} pairs: {dict(total) or 'nothing found'}")
    raise SystemExit(1 if total else 0)


if __name__ == "__main__":
    main()
