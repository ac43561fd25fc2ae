"""Time and memory of whole commands as textures grow: `cutis estimate`, then `cutis edit`.

    python benchmarks/streaming.py FACE [--sides 1024 2048 4096 8192 16384] [--folder FOLDER]

FACE is repeated to squares of half-float OpenEXR (scanlines, ZIP). Each command runs in a process
of its own, files included; maps are stored as half. Peak memory is the process's largest resident
set, the kernel's own count. A side of 16384 needs some 8 GB in FOLDER.
"""

import argparse
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from cutis.colour import LINEAR
from cutis.textures import Texture, read_texture, texture_writer


class Repeated:
    """A face repeated to `side` × `side` texels, made some rows at a time."""

    def __init__(self, face: np.ndarray, side: int) -> None:
        self.face, self.shape = face, (side, side)

    def rows(self, rows: slice) -> Texture:
        first, last, _ = rows.indices(self.shape[0])
        picked = self.face[np.arange(first, last) % len(self.face)]
        times = -(-self.shape[1] // picked.shape[1])
        pixels = np.tile(picked, (1, times, 1))[:, : self.shape[1]]
        return Texture(pixels, ("R", "G", "B"), LINEAR)


def run(*arguments: object) -> tuple[float, float]:
    """Seconds and peak MB of a command."""
    start = time.perf_counter()
    command = [str(Path(sys.executable).parent / "cutis"), *map(str, arguments), "--quiet"]
    process = os.posix_spawn(command[0], command, os.environ)
    _, status, usage = os.wait4(process, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("face")
    parser.add_argument("--sides", nargs="*", type=int, default=[1024, 2048, 4096, 8192, 16384])
    parser.add_argument("--folder", type=Path)
    options = parser.parse_args()
    face = read_texture(options.face).linear().astype(np.float16)
    print("| texels | estimate | peak | ns per texel | edit | peak | ns per texel | load |")
    print("|---|---|---|---|---|---|---|---|")
    for side in options.sides:
        with tempfile.TemporaryDirectory(dir=options.folder) as name:
            folder = Path(name)
            source = Repeated(face, side)
            with texture_writer(folder / "face.exr", source) as writer:
                for top in range(0, side, 64):
                    writer.write(source.rows(slice(top, top + 64)))
            timed, peak = run("estimate", folder / "face.exr", "-o", folder, "--half",
                              "--white", "auto")  # fmt: skip
            again, high = run("edit", folder / "face.skin.exr", "--preset", "tanning", "-o",
                              folder / "tan.exr")  # fmt: skip
            texels = side * side
            print(f"| {side}² | {timed:.1f} s | {peak:.0f} MB | {timed / texels * 1e9:.0f} | "
                  f"{again:.1f} s | {high:.0f} MB | {again / texels * 1e9:.0f} | "
                  f"{os.getloadavg()[0]:.1f} |", flush=True)  # fmt: skip
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
