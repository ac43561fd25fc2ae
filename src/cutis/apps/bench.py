"""`cutis bench`: how fast this machine encodes and decodes."""

from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from cutis.apps.timing import Timed


def bench(
    size: Annotated[int, typer.Option(min=16, max=8192, help="Texels along an edge.")] = 1024,
    repeats: Annotated[int, typer.Option(min=1, help="Runs of each; the best counts.")] = 5,
    seconds: Annotated[
        float, typer.Option(min=0, help="After so long no further round of runs begins.")
    ] = 20.0,
    device: Annotated[
        str, typer.Option(help="cuda: the networks of aliaga2022 on a CUDA device too.")
    ] = "cpu",
    quiet: options.Quiet = False,
) -> None:
    """Time encoding and decoding of SIZE x SIZE float32 texels, all in one run and in turns.

    Uniformly random skins, the same arrays and threads for all: the default model, the networks
    of aliaga2022, the exact space and its spectra. Peak memory is the rise of resident memory.

    Example: cutis bench --size 2048
    """
    from cutis.apps.console import out
    from cutis.apps.timing import announced, copy_bandwidth, matrix_rate, race, table
    from cutis.inverse.device import check_device

    check_device(device)
    with announced(quiet) as say:
        say(f"making {size} × {size} skins")
        entries, threads = contestants(size * size, device)
        for entry in race(entries, repeats, seconds):
            say(f"{entry.system}, {entry.step}: run {len(entry.seconds) + 1} of {repeats}")
        say("copying memory, multiplying matrices")
        bandwidth, rate = copy_bandwidth(threads), matrix_rate()
    out.say(
        f"{size} × {size} texels, {threads} threads; matrix product {rate / 1e9:.0f} GFLOP/s, "
        f"copy {bandwidth / 1e9:.1f} GB/s read and written"
    )
    out.print(table(entries, bandwidth))
    out.print("copying: share of the speed of copying memory")
    out.print("beside PyTorch and ONNX Runtime, in a clone: python -m benchmarks.encoding")


def contestants(count: int, device: str = "cpu") -> tuple[list["Timed"], int]:
    """What is timed on `count` texels, and the threads that it uses."""
    import numpy as np

    from cutis.albedo import albedo_space, uniform
    from cutis.albedo.space import BAND
    from cutis.apps.timing import Timed, pair
    from cutis.kernels import threads
    from cutis.maps import load_model

    space = albedo_space(load_model().tissue)
    skins = uniform(count, seed=0).astype("float32")
    rgb = space.rgb(skins)
    entries = []
    for model in (load_model(), load_model("aliaga2022")):
        entries += pair(model.name, model.encode, model.decode, rgb, skins)
    if device != "cpu":
        model = load_model("aliaga2022", device)
        entries += pair(f"aliaga2022, {device}", model.encode, model.decode, rgb, skins)
    part = np.empty((min(count, BAND), 41), np.float32)

    def streamed() -> None:
        for start in range(0, count, BAND):
            some = skins[start : start + BAND]
            space.reflectance(some, part[: len(some)])

    moved = skins.nbytes // 5 * (5 + 41)
    entries.append(Timed("exact space", "41 bands", streamed, moved))
    entries.append(
        Timed("exact space", "decode", lambda: space.rgb(skins), rgb.nbytes + skins.nbytes)
    )
    return entries, threads()
