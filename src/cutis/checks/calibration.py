"""Exposure and cast: what `--white auto` would take, where that is beyond what faces need."""

from collections.abc import Iterator

import numpy as np

from cutis.checks.evidence import Evidence
from cutis.checks.finding import Finding
from cutis.checks.thresholds import Limits

STEPS = np.exp(np.arange(-1.8, 1.9, 0.3))
"""Exposures that are tried."""


def exposure(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Far brighter or darker than skin can be."""
    if len(seen.colours) < limits["texels"]:
        return
    gain = float(np.prod(seen.gains) ** (1 / 3))
    even = seen.colours * (seen.gains / gain)  # without cast, so that brightness alone is tried
    shares = np.array([seen.share_of(even * step) for step in STEPS])
    best = shares >= shares.max() - limits["near"]
    nearest = float(STEPS[best][np.abs(np.log(STEPS[best])).argmin()])
    reached = shares.max() - seen.share_of(even)
    numbers = {
        "gain": gain, "nearest": nearest, "more": float(reached), "luminance": seen.luminance,
        "brightest": float(np.percentile(seen.skin.mean(axis=1), 98)),
    }  # fmt: skip
    far = reached >= limits["more"]
    if gain <= limits["bright"] or (far and nearest <= limits["far_bright"]) or (
        seen.luminance >= limits["lightest"]
    ):  # fmt: skip
        wanted = min(gain, nearest) if far else gain
        yield Finding(
            "exposure", "finding",
            f"it is too bright for an albedo: skin there would need a gain of {wanted:.2f}.",
            "Estimate with --exposure auto, or expose it anew.", numbers,
        )  # fmt: skip
    elif (far and nearest >= limits["far_dark"]) or seen.luminance <= limits["darkest"]:
        yield Finding(
            "exposure", "finding",
            f"it is too dark for an albedo: colours like these belong to skin {nearest:.1f} times "
            "as bright.",
            "Estimate with --exposure auto, or expose it anew.", numbers,
        )  # fmt: skip


def cast(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """A white balance beyond that of painted and of captured faces."""
    if len(seen.colours) < limits["texels"]:
        return
    red, green, blue = (float(gain) for gain in seen.gains)
    warm, magenta = blue / red, green / np.sqrt(red * blue)
    numbers = {
        "red": red, "green": green, "blue": blue, "blue_over_red": warm,
        "green_over_others": float(magenta),
    }  # fmt: skip
    what = None
    if warm >= limits["warm"]:
        what = "warm (yellow or red)"
    elif warm <= limits["cold"]:
        what = "cold (blue)"
    elif magenta >= limits["magenta"]:
        what = "magenta"
    elif magenta <= limits["green"]:
        what = "green"
    if what is not None:
        yield Finding(
            "cast", "finding",
            f"it has a {what} cast: the gains that fit are {red:.2f}, {green:.2f}, {blue:.2f}.",
            "Estimate with --white auto, or balance it on a grey card.", numbers,
        )  # fmt: skip
