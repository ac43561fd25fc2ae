"""Which tone the skin has: ITA° and the nearest of the Monk scale, with their spread."""

from dataclasses import dataclass

import numpy as np

from cutis.checks.evidence import Evidence
from cutis.colour import ita, lab
from cutis.colour.swatches import MONK, swatch


@dataclass(frozen=True)
class Tone:
    """ITA° at the 5th, 50th and 95th percentile of skin, and the Monk tones (1–10) nearest them."""

    ita: tuple[float, float, float]
    monk: tuple[int, int, int]


def tone(seen: Evidence) -> Tone | None:
    """The tone of the texels that look like skin, as labelled; None without any."""
    if not len(seen.skin):
        return None
    angles = np.asarray(ita(seen.skin))
    low, middle, high = (float(v) for v in np.percentile(angles, [5, 50, 95]))
    lightness = np.asarray(lab(seen.skin))
    dark, usual, light = (
        nearest_monk(np.median(lightness[np.abs(angles - v) <= 2], axis=0)
                     if (np.abs(angles - v) <= 2).any() else lightness[np.abs(angles - v).argmin()])
        for v in (low, middle, high)
    )  # fmt: skip
    return Tone((low, middle, high), (dark, usual, light))


def nearest_monk(colour: np.ndarray) -> int:
    """The Monk tone nearest to a colour (3,) in CIELAB, by distance there."""
    scale = np.asarray(lab(np.stack([swatch(one) for one in MONK]).astype(np.float32)))
    return int(np.linalg.norm(scale - colour, axis=1).argmin()) + 1
