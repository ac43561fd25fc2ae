"""Rebuilds the tables of src/cutis/data/albedo: `python -m studies.build_albedo_table [TISSUE …]`.

TISSUE.npz, spectra from the exact solver, the same names with -rare, those with rare chromophores,
and with -rgb, the colours of all skins.
"""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import IO

from rich.progress import Progress

from cutis.albedo import AlbedoSpace
from cutis.albedo.colour_table import build_colours, save_colours
from cutis.albedo.spectral_table import SpectralTable, build, save, table_file
from cutis.optics import TISSUES, Tissue, tissue_named, with_rare_chromophores
from studies.generated import record

FOLDER = Path(__file__).parents[1] / "src" / "cutis" / "data" / "albedo"


def main() -> None:
    for tissue in map(tissue_named, sys.argv[1:] or TISSUES):
        rare = with_rare_chromophores(tissue)
        write(table_file(rare), partial(save, solved(rare)))
        table = solved(tissue)
        write(table_file(tissue), partial(save, table))
        colours = build_colours(AlbedoSpace(table))
        write(f"{tissue.name}-rgb.npz", partial(save_colours, colours))


def solved(tissue: Tissue) -> SpectralTable:
    with Progress() as progress:
        task = progress.add_task(tissue.name, total=None)
        return build(tissue, lambda done, total: progress.update(task, completed=done, total=total))


def write(name: str, save_to: Callable[[IO[bytes]], None]) -> None:
    part = FOLDER / f".{name}.part"
    try:
        with part.open("wb") as file:
            save_to(file)
        part.replace(FOLDER / name)
    finally:
        part.unlink(missing_ok=True)
    record(FOLDER / name)
    print(f"wrote {name}, {(FOLDER / name).stat().st_size / 1024:.0f} KiB")


if __name__ == "__main__":
    main()
