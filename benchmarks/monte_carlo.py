"""Walks against MCML: `python benchmarks/monte_carlo.py --mcml FOLDER`, a folder of its C sources.

Both walk the three layers of MCML's own sample input (3-D, n = 1.37, a beam straight down), in one
run: first on one core each, then on all cores (MCML as one process per core). MCML is compiled with
gcc -O3. MCML also tallies where light leaves and is absorbed (grids of 40 × 50 × 1, as in its
sample); the walk of cutis scores totals and their standard errors. The error per photon of the
reflected share is reported as well: what counts is time × variance.

Without --mcml only the walks of cutis are timed, among them the white-sky walks that reuse one set
of paths for many absorptions.
"""

import argparse
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from cutis.kernels import use_threads
from cutis.transport import Layer, walk, walk_absorptions

LAYERS = [Layer(1.0, 100.0, 0.9, 0.1), Layer(1.0, 10.0, 0.0, 0.1), Layer(2.0, 10.0, 0.7, 0.2)]
INDEX = 1.37
REPEATS = 3
INPUT = """1.0
1
out.mco A
{photons}
0.01 0.01
40 50 1
3
1
1.37 1 100 0.9 0.1
1.37 1 10 0 0.1
1.37 2 10 0.7 0.2
1
"""


def compile_mcml(sources: Path, folder: Path) -> Path:
    program = folder / "mcml"
    files = [str(p) for p in sorted(sources.glob("mcml*.c"))]
    subprocess.run(["gcc", "-O3", "-o", str(program), *files, "-lm"], check=True)
    return program


def time_mcml(program: Path, folder: Path, photons: int, processes: int) -> tuple[float, float]:
    """Best seconds of REPEATS for `photons` shared by `processes`, and the reflectance found."""
    best, reflected = np.inf, 0.0
    for _ in range(REPEATS):
        places = [folder / f"run{i}" for i in range(processes)]
        for place in places:
            place.mkdir(exist_ok=True)
            (place / "in.mci").write_text(INPUT.format(photons=photons // processes))
        start = time.perf_counter()
        running = [
            subprocess.Popen([str(program), "in.mci"], cwd=place, stdout=subprocess.DEVNULL)
            for place in places
        ]
        for process in running:
            process.wait()
        best = min(best, time.perf_counter() - start)
        found = [
            float(re.findall(r"([\d.eE+-]+)\s*#Diffuse", (p / "out.mco").read_text())[0])
            for p in places
        ]
        reflected = float(np.mean(found))
    return best, reflected


def time_walk(photons: int, threads: int, layers=LAYERS, **how) -> tuple[float, object]:
    """The same for the walk of cutis."""
    use_threads(threads)
    how = {"dimension": 3, "refractive_index": INDEX, "incidence": 1.0} | how
    walk(layers, photons=10, **how)
    best = np.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        found = walk(layers, photons=photons, **how)
        best = min(best, time.perf_counter() - start)
    return best, found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mcml", type=Path, help="folder of mcmlmain.c, mcmlgo.c, …")
    parser.add_argument("--photons", type=int, default=1_000_000)
    given = parser.parse_args()
    cores = os.cpu_count() or 1
    entered = 1 - ((INDEX - 1) / (INDEX + 1)) ** 2
    print(
        f"{given.photons} photons, {cores} cores, load {os.getloadavg()[0]:.1f}, best of {REPEATS}"
    )
    print("| case | cores | µs per photon | reflected | ratio |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        program = compile_mcml(given.mcml, folder) if given.mcml else None
        for count in sorted({1, cores}):
            seconds, found = time_walk(given.photons, count)
            own = f"{entered * found.reflected:.5f} ± {entered * found.reflected_error:.5f}"
            ratio = ""
            if program:
                theirs, reflected = time_mcml(program, folder, given.photons, count)
                ratio = f"{theirs / seconds:.2f}"
                print(f"| MCML, its sample | {count} | {theirs / given.photons * 1e6:.3f} "
                      f"| {reflected:.5f} | 1 |")  # fmt: skip
            print(f"| cutis, the same | {count} | {seconds / given.photons * 1e6:.3f} | {own} "
                  f"| {ratio} |")  # fmt: skip
    skin = [Layer(20.0, 160.0, 0.77, 0.008), Layer(1.0, 160.0, 0.77)]
    for name, how in {
        "skin, 2-D, matched": {"dimension": 2, "refractive_index": 1.0},
        "skin, 2-D, Fresnel": {"dimension": 2, "refractive_index": 1.4},
        "skin, 3-D, matched": {"dimension": 3, "refractive_index": 1.0},
        "skin, 3-D, Fresnel": {"dimension": 3, "refractive_index": 1.4},
    }.items():
        seconds, found = time_walk(given.photons, cores, skin, incidence="lambertian", **how)
        print(f"| {name}, white sky | {cores} | {seconds / given.photons * 1e6:.3f} "
              f"| {found.reflected:.5f} ± {found.reflected_error:.5f} | |")  # fmt: skip
    epidermis, dermis = np.geomspace(1.0, 300.0, 192), np.geomspace(0.3, 200.0, 96)
    best = np.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        walk_absorptions(epidermis, dermis, 80.0, 160.0, 0.77, photons=given.photons // 10)
        best = min(best, time.perf_counter() - start)
    each = best / (given.photons // 10) * 1e6
    print(f"| one set of paths for 192 × 96 skins, 2-D | {cores} | {each:.3f} "
          f"({each / (192 * 96) * 1e3:.2f} ns per photon and skin) | | |")  # fmt: skip


if __name__ == "__main__":
    main()
