"""Rebuilds src/cutis/data/albedo/aliaga2022.npz: run `python tools/build_albedo_table.py`."""

from pathlib import Path

from rich.progress import Progress

from cutis.albedo.spectral_table import build, save
from cutis.optics import ALIAGA2022

FILE = Path(__file__).parents[1] / "src" / "cutis" / "data" / "albedo" / f"{ALIAGA2022.name}.npz"


def main() -> None:
    with Progress() as progress:
        task = progress.add_task("wavelengths", total=None)
        table = build(
            ALIAGA2022, lambda done, total: progress.update(task, completed=done, total=total)
        )
    part = FILE.with_name(f".{FILE.name}.part")
    try:
        with part.open("wb") as file:
            save(table, file)
        part.replace(FILE)
    finally:
        part.unlink(missing_ok=True)
    print(f"wrote {FILE.name}, {FILE.stat().st_size / 1024:.0f} KiB")


if __name__ == "__main__":
    main()
