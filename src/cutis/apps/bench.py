"""`cutis bench`: how fast this machine encodes and decodes, beside other ways of doing it."""

from typing import TYPE_CHECKING, Annotated

import typer

from cutis.apps import options

if TYPE_CHECKING:
    from rich.table import Table

    from cutis.apps.timing import Timed

RIVALS = ("PyTorch, one call", "PyTorch, tiles")
"""BioSkin's network; the faster of the two is what others are compared with."""


def bench(
    size: Annotated[int, typer.Option(min=16, max=8192, help="Texels along an edge.")] = 2048,
    repeats: Annotated[int, typer.Option(min=1, help="Runs of each; the best counts.")] = 5,
    device: Annotated[
        str, typer.Option(help="cuda: the networks of aliaga2022 on a CUDA device too.")
    ] = "cpu",
    quiet: options.Quiet = False,
) -> None:
    """Time encoding and decoding of SIZE x SIZE float32 texels, all in one run and in turns.

    Uniformly random skins, the same arrays and threads for all: the default model, the networks
    of aliaga2022, BioSkin's network (same layers, random weights) in PyTorch and ONNX Runtime
    where they are installed, and spectra. Peak memory is the rise of resident memory.

    Example: cutis bench --size 1024
    """
    from cutis.apps.console import bar, out
    from cutis.apps.timing import copy_bandwidth, matrix_rate, race

    entries, missing, threads = contestants(size * size, device)
    with bar(quiet) as progress:
        for number, entry in enumerate(race(entries, repeats)):
            progress(number, len(entries) * (repeats + 1), f"{entry.system}: {entry.step}")
    bandwidth, rate = copy_bandwidth(threads), matrix_rate()
    out.print(
        f"{size} × {size} texels, {threads} threads; matrix product {rate / 1e9:.0f} GFLOP/s, "
        f"copy {bandwidth / 1e9:.1f} GB/s read and written"
    )
    out.print(table(entries, bandwidth))
    if rival := fastest_rival(entries):
        out.print(f"ratio: how many times as fast as {rival}; copying: share of its speed")
    for line in missing:
        out.print(line)


def contestants(count: int, device: str = "cpu") -> tuple[list["Timed"], list[str], int]:
    """What is timed on `count` texels, a line for each that is not installed, the threads."""
    import numpy as np

    from cutis.albedo import albedo_space, uniform
    from cutis.albedo.space import BAND
    from cutis.apps.rivals import onnx_step, random_networks, tiled, torch_step
    from cutis.apps.timing import Timed
    from cutis.inverse.device import check_device
    from cutis.kernels import threads as threads_of_kernels
    from cutis.maps import load_model

    check_device(device)
    threads = threads_of_kernels()
    space, networks = albedo_space(load_model().tissue), random_networks()
    skins = uniform(count, seed=0).astype("float32")
    rgb = space.rgb(skins)
    moved = rgb.nbytes + skins.nbytes
    entries = []

    def add(system: str, encode: object, decode: object) -> None:
        entries.append(Timed(system, "encode", lambda: encode(rgb), moved))  # type: ignore[operator]
        entries.append(Timed(system, "decode", lambda: decode(skins), moved))  # type: ignore[operator]

    for model in (load_model(), load_model("aliaga2022")):
        add(model.name, model.encode, model.decode)
    if device != "cpu":
        model = load_model("aliaga2022", device)
        add(f"aliaga2022, {device}", model.encode, model.decode)
    missing = []
    for name, make, extra in (
        ("PyTorch", torch_step, "train"),
        ("ONNX", onnx_step, "onnx"),
    ):
        try:
            encode, decode = (make(n, threads) for n in (networks.encoder, networks.decoder))
        except ModuleNotFoundError as error:
            missing.append(
                f"{name} is not timed: {error.name} is missing; pip install 'cutis[{extra}]'"
            )
            continue
        add(f"{name}, one call", encode, decode)
        add(f"{name}, tiles", tiled(encode, 5), tiled(decode, 3))
    spectra = skins.nbytes // 5 * 41
    entries.append(
        Timed("exact space", "41 bands", lambda: space.reflectance(skins), skins.nbytes + spectra)
    )
    part = np.empty((min(count, BAND), 41), np.float32)

    def streamed() -> None:
        for start in range(0, count, BAND):
            some = skins[start : start + BAND]
            space.reflectance(some, part[: len(some)])

    entries.append(Timed("exact space", "streamed", streamed, skins.nbytes + spectra))
    entries.append(Timed("exact space", "decode", lambda: space.rgb(skins), moved))
    return entries, missing, threads


def table(entries: list["Timed"], bandwidth: float) -> "Table":
    """Times, ratios to the rival and to the floor, memory."""
    from rich.table import Table

    by_system: dict[str, list[Timed]] = {}
    for entry in entries:
        by_system.setdefault(entry.system, []).append(entry)
    rival = fastest_rival(entries)
    theirs = {e.step: e.best for e in by_system.get(rival or "", [])}
    result = Table(box=None)
    for heading in ("", "", "best", "median", "ratio", "copying", "memory"):
        result.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for system, own in by_system.items():
        for entry in own:
            ratio = f"{theirs[entry.step] / entry.best:.2f}" if entry.step in theirs else ""
            result.add_row(
                system if entry is own[0] else "",
                entry.step,
                f"{entry.best:.3f} s",
                f"{entry.median:.3f} s",
                ratio,
                f"{100 * entry.moved / bandwidth / entry.best:.1f} %",
                "" if entry.peak is None else f"{entry.peak / 1e6:.0f} MB",
            )
        if {e.step for e in own} == {"encode", "decode"}:
            total = sum(e.best for e in own)
            ratio = f"{sum(theirs.values()) / total:.2f}" if rival else ""
            result.add_row("", "both", f"{total:.3f} s", "", ratio, "", "")
    return result


def fastest_rival(entries: list["Timed"]) -> str | None:
    """Of RIVALS, the one that takes least for encoding and decoding."""
    totals = {
        rival: sum(entry.best for entry in entries if entry.system == rival) for rival in RIVALS
    }
    return min((rival for rival in RIVALS if totals[rival]), key=totals.__getitem__, default=None)
