"""Learns priors of measured skin: `python -m studies.train_prior [MODEL …]`, with the shared data.

Writes MODEL-prior.npz into src/cutis/data/weights; then `cutis train MODEL` bakes the tables beside
it. NIST's forearms count as an origin like the others.
"""

import argparse
from pathlib import Path

from rich.progress import Progress

from cutis.inverse.prior import SkinPrior, save_prior
from cutis.inverse.shipped import MEASURED, TISSUE_OF, VARYING
from cutis.textures import replacing
from studies.figures.measured import read_skins
from studies.generated import record
from studies.prior_training import MeasuredSkins, train_prior

ROOT = Path(__file__).parents[1]
WEIGHTS = ROOT / "src" / "cutis" / "data" / "weights"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    shared = ROOT.parent / "shared" / "data"
    parser.add_argument("models", nargs="*", default=[MEASURED, VARYING], help="all unless named")
    parser.add_argument("--data", type=Path, default=shared, help="the shared data")
    given = parser.parse_args()
    skins = read_skins(given.data)
    for name in given.models:
        prior = learned(skins, name)
        target = WEIGHTS / f"{name}-prior.npz"
        with replacing(target) as partial:
            save_prior(prior, partial)
        record(target)
        print(f"wrote {target.name}, {target.stat().st_size} bytes")


def learned(skins: MeasuredSkins, name: str) -> SkinPrior:
    with Progress() as progress:
        task = progress.add_task(name, total=None)
        return train_prior(
            skins,
            TISSUE_OF[name],
            lambda done, n: progress.update(task, completed=done, total=n),
        )


if __name__ == "__main__":
    main()
