"""Bakes the shipped models that are baked, with `cutis train`, into src/cutis/data/weights.

python -m studies.build_weights [RECIPE …]
"""

import sys
from pathlib import Path

from cutis.apps.train import train
from cutis.inverse.shipped import EXACT, MEASURED
from studies.generated import record

WEIGHTS = Path(__file__).parents[1] / "src" / "cutis" / "data" / "weights"


def main() -> None:
    for recipe in sys.argv[1:] or (MEASURED, EXACT):
        train(recipe, WEIGHTS)
        record(*sorted(set(WEIGHTS.glob(f"{recipe}*.npz")) - {WEIGHTS / f"{recipe}-prior.npz"}))


if __name__ == "__main__":
    main()
