"""Many textures: one process and two, one Dask worker and two, on the same files in one run.

    python benchmarks/scaling.py FACE [--side 2048] [--count 8]

COUNT squares of FACE as half OpenEXR are estimated with `--jobs 1`, `--jobs 2`, and on a Dask
scheduler here with one worker and with two, of one thread each: two halves of two cores. Times are
of whole commands, start-up included.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from streaming import Repeated

from cutis.textures import read_texture, texture_writer

BIN = Path(sys.executable).parent


def estimated(folder: Path, *flags: str) -> float:
    """Seconds that estimating all textures of a folder takes."""
    start = time.perf_counter()
    subprocess.run([BIN / "cutis", "estimate", folder, "--half", "--again", "--quiet",
                    "-o", folder / "out", *flags], check=True)  # fmt: skip
    return time.perf_counter() - start


def on_workers(folder: Path, count: int) -> float:
    """The same on a scheduler with `count` workers of one thread."""
    address, one = "tcp://127.0.0.1:8799", {**os.environ, "CUTIS_THREADS": "1"}
    scheduler = subprocess.Popen([BIN / "dask", "scheduler", "--port", "8799", "--no-dashboard"],
                                 stderr=subprocess.DEVNULL)  # fmt: skip
    workers = [
        subprocess.Popen([BIN / "dask", "worker", address, "--nthreads", "1", "--no-dashboard"],
                         stderr=subprocess.DEVNULL, env=one)
        for _ in range(count)
    ]  # fmt: skip
    try:
        time.sleep(8)  # until all are there
        return estimated(folder, "--cluster", address)
    finally:
        for process in (*workers, scheduler):
            process.terminate()
            process.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("face")
    parser.add_argument("--side", type=int, default=2048)
    parser.add_argument("--count", type=int, default=8)
    options = parser.parse_args()
    face = read_texture(options.face).linear().astype(np.float16)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(options.count):
            source = Repeated(np.roll(face, 37 * number, axis=0), options.side)
            with texture_writer(folder / f"face{number}.exr", source) as writer:
                writer.write(source.rows(slice(None)))
        estimated(folder, "--jobs", "1")  # compiles what is not yet
        print("| how | seconds | load |\n|---|---|---|")
        for how, run in (
            ("--jobs 1", lambda: estimated(folder, "--jobs", "1")),
            ("--jobs 2", lambda: estimated(folder, "--jobs", "2")),
            ("--cluster, 1 worker of 1 thread", lambda: on_workers(folder, 1)),
            ("--cluster, 2 workers of 1 thread", lambda: on_workers(folder, 2)),
        ):
            print(f"| {how} | {run():.1f} | {os.getloadavg()[0]:.1f} |", flush=True)


if __name__ == "__main__":
    main()
