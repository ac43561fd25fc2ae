"""What storing does to fine tones: steps between few codes, and the blocks of JPEG."""

from collections.abc import Iterator

import numpy as np

from cutis.arrays import Floats
from cutis.checks.evidence import Evidence, shown
from cutis.checks.finding import Finding, graded
from cutis.checks.thresholds import Limits
from cutis.textures import Texture

LUMA = np.array([0.299, 0.587, 0.114])


def windows(seen: Evidence) -> Iterator[tuple[int, int, Floats]]:
    """Windows in full size as codes of a display, 0 to 255, with their place."""
    found = seen.gathered
    for top, left, values in found.windows:
        part = Texture(np.ascontiguousarray(values), ("R", "G", "B"), found.stored.space)
        yield top, left, shown(part.linear())


def blocks(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Steps at every eighth column and row, beyond those between."""
    steps = block_steps(list(windows(seen)))
    level = graded(steps, limits["note"], limits["finding"])
    if level is not None:
        yield Finding(
            "jpeg-blocks", level,
            f"JPEG has left blocks: their borders are {steps:.1f} codes of 255 higher than what is "
            "between.",
            "Take the original, or save with a higher quality: maps show blocks before eyes do.",
            {"step": steps, "note": limits["note"], "limit": limits["finding"]},
        )  # fmt: skip


def block_steps(parts: list[tuple[int, int, Floats]]) -> float:
    """How much steps at multiples of 8 exceed those between, in codes; the lesser direction."""
    found = []
    for axis in (0, 1):
        sums, counts = np.zeros(8), np.zeros(8)
        for top, left, codes in parts:
            luma = codes @ LUMA
            lines = luma if axis else luma.T
            step = np.abs(np.diff(lines, axis=1))
            if step.shape[1] < 16:
                continue
            more = step[:, 1:-1] - 0.5 * (step[:, :-2] + step[:, 2:])
            phase = ((left if axis else top) + 2 + np.arange(more.shape[1])) % 8
            np.add.at(sums, phase, more.sum(axis=0))
            np.add.at(counts, phase, float(len(more)))
        if not counts.all():
            return 0.0
        means = sums / counts
        highest = int(means.argmax())
        found.append(float(means[highest] - np.median(np.delete(means, highest))))
    return min(found)


def banding(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Codes that are left out between those that are used: too few bits, or stretched tones."""
    step = code_step(list(windows(seen)))
    level = graded(step, limits["note"], limits["finding"])
    if level is not None:
        yield Finding(
            "banding", level,
            f"its tones come in steps of {step:.1f} codes of 255, where 1 is the finest of 8 bits.",
            "Take the original with more bits; noise or a blur in 16 bits hides what is there.",
            {"step": step, "note": limits["note"], "limit": limits["finding"]},
        )  # fmt: skip


def code_step(parts: list[tuple[int, int, Floats]]) -> float:
    """Typical distance between neighbouring codes that are used, worst of the channels.

    Codes are counted where a channel has most of its texels, from its 5th to its 95th percentile.
    """
    if not parts:
        return 0.0
    codes = np.concatenate([c.reshape(-1, 3) for _, _, c in parts])
    worst = 0.0
    for channel in codes.T:
        counts = np.bincount(np.rint(channel * 4).astype(int).clip(0, 1020), minlength=1021)
        share = counts.cumsum() / max(1, counts.sum())
        low, high = np.searchsorted(share, [0.05, 0.95])
        if high - low < 24:
            continue
        used = np.flatnonzero(counts[low : high + 1] > 1e-5 * counts.sum())
        if len(used) > 2:
            worst = max(worst, float(np.median(np.diff(used))) / 4)
    return worst
