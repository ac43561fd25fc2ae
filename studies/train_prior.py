"""Learns the prior of measured skin: run `python -m studies.train_prior`, with the shared data.

Writes src/cutis/data/weights/measured2026-prior.npz; then `cutis train measured2026` bakes the
tables beside it. NIST's forearms count as an origin like the others.
"""

import argparse
from pathlib import Path

from rich.progress import Progress

from cutis.inverse.prior import save_prior
from cutis.optics import MEASURED2026
from cutis.textures import replacing
from studies.figures.measured import read_skins
from studies.generated import record
from studies.prior_training import train_prior

ROOT = Path(__file__).parents[1]
TARGET = ROOT / "src" / "cutis" / "data" / "weights" / "measured2026-prior.npz"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    shared = ROOT.parent / "shared" / "data"
    parser.add_argument("data", type=Path, nargs="?", default=shared, help="the shared data")
    skins = read_skins(parser.parse_args().data)
    with Progress() as progress:
        task = progress.add_task("folds", total=None)
        prior = train_prior(
            skins, MEASURED2026, lambda done, n: progress.update(task, completed=done, total=n)
        )
    with replacing(TARGET) as partial:
        save_prior(prior, partial)
    record(TARGET)
    print(f"wrote {TARGET.name}, {TARGET.stat().st_size} bytes")


if __name__ == "__main__":
    main()
