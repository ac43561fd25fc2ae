"""The search of the look-up tensor against SciPy's k-d tree: `python benchmarks/lookup.py FACE`.

FACE is a texture, scaled to 2048² texels. Three sets of colours in one run on all cores: the face,
the face with 1 % noise (no colour twice) and uniformly random RGB, all against 256 000 skins.
SciPy's tree is timed on every 16th (random RGB: 128th) colour and its time scaled up; brute force
on 200 colours on one core, its time shared by all cores.
"""

import argparse
import os
import time
from pathlib import Path

import numpy as np

from cutis import read
from cutis.inverse.lookup import lookup_tensor

SIDE = 2048
BAND = 1 << 18


def seconds(search, colours: np.ndarray, repeats: int) -> float:
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        for first in range(0, len(colours), BAND):
            search(colours[first : first + BAND])
        best = min(best, time.perf_counter() - start)
    return best


def brute_force(points: np.ndarray, colours: np.ndarray) -> None:
    for colour in colours.astype(np.float64):
        np.argmin(((colour - points) ** 2).sum(axis=1))


def main() -> None:
    from scipy.spatial import cKDTree

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("face", type=Path)
    face = read(parser.parse_args().face).linear()
    rows, columns = (np.arange(SIDE) * n // SIDE for n in face.shape[:2])
    face = face[rows][:, columns].reshape(-1, 3)
    rng = np.random.default_rng(0)
    sets = {
        "face": face,
        "face with 1 % noise": (face * (1 + 0.01 * rng.standard_normal(face.shape))).astype("f4"),
        "random RGB": rng.random(face.shape, dtype=np.float32),
    }
    tensor = lookup_tensor("lookup")
    start = time.perf_counter()
    tensor.nearest(face[:1000])
    print(f"{len(tensor.colours)} skins, {len(face)} colours, load {os.getloadavg()[0]:.1f}; "
          f"tree and compilation {time.perf_counter() - start:.1f} s")  # fmt: skip
    tree = cKDTree(tensor.colours)
    points = tensor.colours.astype(np.float64)
    print("| colours | cutis | SciPy cKDTree | ratio | brute force |\n|---|---|---|---|---|")
    for name, colours in sets.items():
        thin = 128 if name == "random RGB" else 16
        ours = seconds(tensor.nearest, colours, 3)
        theirs = seconds(lambda c: tree.query(c, workers=-1), colours[::thin], 1) * thin
        few = seconds(lambda c: brute_force(points, c), colours[:: len(colours) // 200], 1)
        whole = few * len(colours) / 200 / (os.cpu_count() or 1) / 60
        print(f"| {name} | {ours:.2f} s | {theirs:.1f} s | {theirs / ours:.1f} | {whole:.0f} min |")


if __name__ == "__main__":
    main()
