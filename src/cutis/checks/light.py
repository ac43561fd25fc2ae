"""Baked light: shade that lies on one side of a face, or that colour cannot explain."""

from collections.abc import Iterator

import numpy as np
from scipy.ndimage import binary_erosion

from cutis.arrays import Floats, Where
from cutis.checks.evidence import LUMINANCE, Evidence, blurred
from cutis.checks.finding import Finding, graded
from cutis.checks.thresholds import Limits


def check(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Light from one side, and light that is uneven without a change of colour."""
    if seen.skin_blocks.sum() < limits["blocks"]:
        return
    alike, side = asymmetry(seen)
    broad = unevenness(seen)
    numbers = {"alike": alike, "side": side, "uneven": broad}
    level = None
    if alike >= limits["alike"]:
        level = graded(side, limits["side_note"], limits["side"])
    if level is not None:
        yield Finding(
            "baked-light", level,
            f"light comes from one side: left and right differ by {100 * side:.0f} % in light.",
            "Take the light out before estimating, or mask what is shaded.", numbers,
        )  # fmt: skip
        return
    level = graded(broad, limits["uneven_note"], limits["uneven"])
    if level is not None:
        yield Finding(
            "baked-light", level,
            f"brightness changes by {100 * broad:.0f} % across the face without the change of "
            "colour that melanin or blood would bring.",
            "Take the light out before estimating, or mask what is shaded.", numbers,
        )  # fmt: skip


def occlusion(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Creases and sockets that are dark without a change of colour."""
    if seen.skin_blocks.sum() < limits["blocks"]:
        return
    depth = creases(seen)
    level = graded(depth, limits["note"], limits["finding"])
    if level is not None:
        yield Finding(
            "occlusion", level,
            f"creases are {100 * (1 - np.exp(-depth)):.0f} % darker than around them, in grey: "
            "soft occlusion is baked in.",
            "Divide by the ambient occlusion of the mesh, if it is at hand.",
            {"depth": depth, "note": limits["note"], "limit": limits["finding"]},
        )  # fmt: skip


def logs(seen: Evidence) -> Floats:
    """(h, w) logarithms of luminance."""
    return np.log(np.maximum(seen.balanced @ LUMINANCE, 1e-4))


def smooth(seen: Evidence) -> Where:
    """Skin without hair, brows and lips: where luminance hardly varies from block to block."""
    skin = seen.skin_blocks
    weight, light = skin.astype(float), logs(seen)
    base, _ = blurred(light, weight, 2.0)
    rough, _ = blurred(np.where(skin, (light - base) ** 2, 0), weight, 0.02 * seen.size)
    rough = np.sqrt(rough)
    around, _ = blurred(np.exp(light), weight, 0.02 * seen.size)
    bright = around > 0.5 * np.percentile(around[skin], 80)
    return skin & (rough < 2 * np.percentile(rough[skin], 30)) & bright


def unevenness(seen: Evidence) -> float:
    """Standard deviation of broad log luminance that a face's own change of colour leaves."""
    chosen = smooth(seen)
    if chosen.sum() < 100:
        return 0.0
    weight = chosen.astype(float)
    parts = [
        blurred(np.log(np.maximum(seen.balanced[..., i], 1e-4) + 0.003), weight, 0.04 * seen.size)
        for i in range(3)
    ]
    sure = chosen & (parts[0][1] > 0.3)
    if sure.sum() < 100:
        return 0.0
    red, green, blue = (part[sure] for part, _ in parts)
    mean = (red + green + blue) / 3
    terms = np.stack([np.ones(len(mean)), red - green, blue - green], axis=1)
    fitted, *_ = np.linalg.lstsq(terms, mean, rcond=None)
    return float((mean - terms @ fitted).std())


def asymmetry(seen: Evidence) -> tuple[float, float]:
    """How alike left and right are in fine detail, and how they differ in broad brightness.

    The first is a correlation across the best upright axis near the middle, the second half the
    standard deviation of the difference of log luminance, blurred.
    """
    skin = seen.skin_blocks
    light, weight = logs(seen), skin.astype(float)
    broad, near = blurred(light, weight, 0.04 * seen.size)
    fine = np.where(skin, light - broad, 0)
    sure = skin & (near > 0.3)
    width = skin.shape[1]
    best, axis = -1.0, width
    for candidate in range(int(0.8 * width), int(1.2 * width)):
        here, there = mirrored(candidate, width)
        both = skin[:, here] & skin[:, there][:, ::-1]
        if both.sum() < 0.4 * skin.sum():
            continue
        a, b = fine[:, here][both], fine[:, there][:, ::-1][both]
        alike = float((a * b).sum() / np.sqrt((a**2).sum() * (b**2).sum() + 1e-12))
        if alike > best:
            best, axis = alike, candidate
    if best < 0:
        return 0.0, 0.0
    here, there = mirrored(axis, width)
    both = sure[:, here] & sure[:, there][:, ::-1]
    difference = 0.5 * (broad[:, here] - broad[:, there][:, ::-1])[both]
    return best, float(np.sqrt((difference**2).mean())) if len(difference) else 0.0


def mirrored(axis: int, width: int) -> tuple[slice, slice]:
    """Columns left of an axis (at axis / 2), and those right of it that mirror them reversed."""
    low, high = max(0, axis - width + 1), min(width - 1, axis)
    return slice(low, high + 1), slice(axis - high, axis - low + 1)


def creases(seen: Evidence) -> float:
    """Depth of narrow shade in log luminance, at the lowest 2 % of smooth skin.

    Only what has the colour of its surroundings counts: hair, moles and lips have another.
    """
    skin = binary_erosion(seen.skin_blocks, iterations=2)
    if skin.sum() < 100:
        return 0.0
    weight, light = seen.skin_blocks.astype(float), logs(seen)
    fine, _ = blurred(light, weight, 0.012 * seen.size)
    broad, _ = blurred(light, weight, 0.06 * seen.size)
    ratios = []
    for i, j in ((0, 1), (2, 1)):
        ratio = np.log(np.maximum(seen.balanced[..., i], 1e-4) + 0.003) - np.log(
            np.maximum(seen.balanced[..., j], 1e-4) + 0.003
        )
        narrow, _ = blurred(ratio, weight, 0.012 * seen.size)
        wide, _ = blurred(ratio, weight, 0.06 * seen.size)
        ratios.append(np.abs(narrow - wide))
    grey = skin & (np.maximum(*ratios) < 0.05)
    depth = np.where(grey, broad - fine, 0)[skin]
    return float(np.percentile(depth, 98))
