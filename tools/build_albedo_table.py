"""Rebuilds the tables of src/cutis/data/albedo: run `python tools/build_albedo_table.py`.

aliaga2022.npz, spectra from the exact solver, and aliaga2022-rgb.npz, the colours of all skins.
"""

from collections.abc import Callable
from pathlib import Path
from typing import IO

from rich.progress import Progress

from cutis.albedo import AlbedoSpace
from cutis.albedo.colour_table import build_colours, save_colours
from cutis.albedo.spectral_table import build, save
from cutis.optics import ALIAGA2022

FOLDER = Path(__file__).parents[1] / "src" / "cutis" / "data" / "albedo"


def main() -> None:
    with Progress() as progress:
        task = progress.add_task("wavelengths", total=None)
        table = build(
            ALIAGA2022, lambda done, total: progress.update(task, completed=done, total=total)
        )
    write(f"{ALIAGA2022.name}.npz", lambda file: save(table, file))
    colours = build_colours(AlbedoSpace(table))
    write(f"{ALIAGA2022.name}-rgb.npz", lambda file: save_colours(colours, file))


def write(name: str, save_to: Callable[[IO[bytes]], None]) -> None:
    part = FOLDER / f".{name}.part"
    try:
        with part.open("wb") as file:
            save_to(file)
        part.replace(FOLDER / name)
    finally:
        part.unlink(missing_ok=True)
    print(f"wrote {name}, {(FOLDER / name).stat().st_size / 1024:.0f} KiB")


if __name__ == "__main__":
    main()
