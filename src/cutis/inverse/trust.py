"""How far to trust the most probable skin of a colour, baked like the skin itself.

The table holds, over a coarser chart, the logarithms of the standard deviations of `prior.py` in
the parameters' units, and the confidence.
"""

import numpy as np
from numpy.typing import NDArray

from cutis.albedo import AlbedoSpace
from cutis.inverse.baked import MEASURED_CHART, Baked, Chart, Solver
from cutis.inverse.prior import SkinPrior, unit_slopes
from cutis.optics import PARAMETERS

TRUST_CHART = Chart(MEASURED_CHART.low, MEASURED_CHART.high, (56, 40, 44))
"""σ varies slowly: half the cells of the skins along each axis."""
WIDTHS = np.array([known.high - known.low for known in PARAMETERS], dtype=np.float32)
"""Of the ranges of the parameters: ± 1.645 of them hold anything."""


def trust_of(prior: SkinPrior, space: AlbedoSpace) -> Solver:
    """Colours (n, 3) → (n, 6): log σ of the most probable skin, in units, and confidence."""

    def solve(colours: NDArray[np.float32]) -> NDArray[np.float64]:
        skins = prior.skins(space, colours)
        sigma, confidence = prior.trust(space, colours, skins)
        logs = np.log(sigma * unit_slopes(skins.astype(np.float64)))
        return np.concatenate([logs, confidence[:, None]], axis=1)

    return solve


def look_up_trust(table: Baked, colours: NDArray[np.float32]) -> NDArray[np.float32]:
    """(n, 3) calibrated linear sRGB → (n, 6): σ of the five in their units, and confidence.

    No σ is wider than its range, as in files: off measured skin the logarithms grow without bound.
    """
    found = table.values(colours)
    np.exp(found[:, :5], out=found[:, :5])
    np.minimum(found[:, :5], WIDTHS, out=found[:, :5])
    np.clip(found[:, 5], 0, 1, out=found[:, 5])
    return found
