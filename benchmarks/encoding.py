"""Encoding and decoding beside PyTorch and ONNX Runtime: `cutis bench` with its rivals.

    python -m benchmarks.encoding [--size 2048] [--repeats 5]

The rivals have BioSkin's RGB network, the same layers with random weights, once in one call and
once in tiles. They need `pip install 'cutis[train,onnx]'`; one that is missing is named. In one
call they take 2.5 GB for 2048² texels.
"""

import argparse

from benchmarks.rivals import onnx_step, random_networks, tiled, torch_step
from cutis.albedo import albedo_space, uniform
from cutis.apps.bench import contestants
from cutis.apps.console import out
from cutis.apps.timing import (
    Timed,
    announced,
    copy_bandwidth,
    fastest,
    matrix_rate,
    pair,
    race,
    table,
)
from cutis.maps import load_model

RIVALS = ("PyTorch, one call", "PyTorch, tiles")
"""BioSkin's network; the faster of the two is what others are compared with."""


def rivals(count: int, threads: int) -> tuple[list[Timed], list[str]]:
    """Rivals on `count` texels, and a line for each that is not installed."""
    networks = random_networks()
    skins = uniform(count, seed=0).astype("float32")
    rgb = albedo_space(load_model().tissue).rgb(skins)
    entries, missing = [], []
    for name, make, extra in (("PyTorch", torch_step, "train"), ("ONNX", onnx_step, "onnx")):
        try:
            encode, decode = (make(n, threads) for n in (networks.encoder, networks.decoder))
        except ModuleNotFoundError as error:
            missing.append(
                f"{name} is not timed: {error.name} is missing; pip install 'cutis[{extra}]'"
            )
            continue
        entries += pair(f"{name}, one call", encode, decode, rgb, skins)
        entries += pair(f"{name}, tiles", tiled(encode, 5), tiled(decode, 3), rgb, skins)
    return entries, missing


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=2048, help="texels along an edge")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each; the best counts")
    given = parser.parse_args()
    with announced(quiet=False) as say:
        say("making skins and networks")
        entries, threads = contestants(given.size**2)
        others, missing = rivals(given.size**2, threads)
        entries += others
        for entry in race(entries, given.repeats):
            say(f"{entry.system}, {entry.step}: run {len(entry.seconds) + 1} of {given.repeats}")
        bandwidth, rate = copy_bandwidth(threads), matrix_rate()
    out.print(
        f"{given.size}² texels, {threads} threads; matrix product {rate / 1e9:.0f} GFLOP/s, copy "
        f"{bandwidth / 1e9:.1f} GB/s read and written"
    )
    out.print(table(entries, bandwidth, RIVALS))
    if rival := fastest(entries, RIVALS):
        out.print(f"ratio: how many times as fast as {rival}; copying: share of its speed")
    for line in missing:
        out.print(line)


if __name__ == "__main__":
    main()
