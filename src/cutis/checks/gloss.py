"""Baked gloss: light that the surface mirrors is white and lies on top of the skin's own."""

from collections.abc import Iterator

import numpy as np
from scipy.ndimage import binary_erosion, minimum_filter

from cutis.arrays import Where
from cutis.checks.evidence import LUMINANCE, Evidence, blurred
from cutis.checks.finding import Finding, graded
from cutis.checks.thresholds import Limits


def check(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Small areas that exceed bright skin in all channels by the same amount of light."""
    core = among_skin(seen, limits["among"])
    if core.sum() < limits["blocks"]:
        return
    added, base = excess(seen, core)
    level = graded(added / base, limits["note"], limits["finding"])
    if level is not None and added >= limits["absolute"]:
        yield Finding(
            "gloss",
            level,
            f"there are highlights: light of {added:.2f} lies on skin of {base:.2f}, in red, green "
            "and blue alike.",
            "An albedo has none: capture with crossed polarisers, or mask them out.",
            {"added": added, "skin": base, "relative": added / base, "limit": limits["finding"]},
        )


def among_skin(seen: Evidence, share: float) -> Where:
    """Blocks inside the mask around which at least a share of all is skin."""
    inside = seen.inside.astype(float)
    around, _ = blurred(seen.skin_blocks.astype(float), inside, 0.05 * seen.size)
    return binary_erosion(seen.inside, iterations=3) & (around >= share)


def excess(seen: Evidence, core: Where) -> tuple[float, float]:
    """White light beyond bright skin in the brightest 0.1 % of blocks, and bright skin itself.

    Highlights are soft: the least of 5 × 5 blocks leaves them, and takes letters and edges away.
    """
    weight = seen.inside.astype(float)
    sigma = 0.006 * seen.size
    channels = [
        blurred(minimum_filter(seen.balanced[..., i], 5), weight, sigma)[0][core] for i in range(3)
    ]
    near = np.stack(channels, axis=-1)
    bright = np.percentile(near, 90, axis=0)
    return float(np.percentile((near - bright).min(axis=-1), 99.9)), float(bright @ LUMINANCE)
