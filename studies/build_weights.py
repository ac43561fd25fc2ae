"""Bakes the shipped models that are baked, with `cutis train`, into src/cutis/data/weights.

python -m studies.build_weights [RECIPE …]
"""

import sys
from pathlib import Path

from cutis.apps.train import train
from cutis.inverse.shipped import TISSUE_OF
from studies.generated import record

WEIGHTS = Path(__file__).parents[1] / "src" / "cutis" / "data" / "weights"


def main() -> None:
    for recipe in sys.argv[1:] or TISSUE_OF:
        train(recipe, WEIGHTS)
        record(
            *(f for f in (WEIGHTS / f"{recipe}{end}.npz" for end in ("", "-trust")) if f.is_file())
        )


if __name__ == "__main__":
    main()
