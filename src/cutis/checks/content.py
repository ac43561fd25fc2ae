"""Whether there is skin to speak of: size, scale of numbers, variety, share of skin, the mask."""

from collections.abc import Iterator

import numpy as np

from cutis.checks.evidence import Evidence
from cutis.checks.finding import Finding, graded
from cutis.checks.thresholds import Limits
from cutis.report.words import percent


def scale(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Numbers that are no shares of light: 0–255 in a float file, or light above one."""
    values, inside = seen.gathered.values, seen.gathered.sure
    if not inside.any():
        return
    high = float(np.percentile(values[inside], 95))
    if high >= limits["codes"]:
        largest = next(top for top in (255.0, 1023.0, 4095.0, 65535.0, np.inf) if high <= top)
        divide = "" if np.isinf(largest) else f" Divide by {largest:.0f}."
        yield Finding(
            "scale", "finding",
            f"values reach {high:.3g}, where an albedo ends at 1: they look like codes, not shares "
            "of light.",
            f"{divide} Then say --colorspace sRGB if they are a picture's codes.".strip(),
            {"p95": high, "limit": limits["codes"]},
        )  # fmt: skip


def amount(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """Too few texels, or one flat colour: nothing can be said of a face."""
    count = seen.gathered.tallies.inside
    if count < limits["texels"]:
        yield Finding(
            "size", "finding",
            f"only {count} texels are inside the mask, too few to say anything of a skin.",
            "Give a texture of at least some hundred texels.",
            {"texels": count, "limit": limits["texels"]},
        )  # fmt: skip
        return
    spread = seen.colours.std(axis=0).max() / max(1e-6, float(np.abs(seen.colours).mean()))
    if spread < limits["spread"]:
        yield Finding(
            "flat", "finding",
            "all of it has one colour: this is a swatch, not a texture of a face.",
            "Its maps are those of one colour and nothing more.",
            {"spread": float(spread), "limit": limits["spread"]},
        )  # fmt: skip


def mask(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """A mask that holds everything but the skin."""
    found = seen.gathered
    if not found.masked or not found.sure.any() or found.sure.all():
        return
    inside, outside = seen.share_balanced, seen.share_of(
        seen.outside * seen.gains_of(seen.outside)
    )  # fmt: skip
    flat_in, flat_out = flat_share(seen)
    more = max(outside - inside, flat_in - flat_out)
    border = border_cover(seen)
    if more >= limits["more"] and border >= limits["border"]:
        yield Finding(
            "mask-inverted", "finding",
            f"the mask looks inverted: inside it {percent(inside)} have the colour of skin, off it "
            f"{percent(outside)}, and it holds {percent(border)} of the picture's border.",
            "Invert it, or paint white what is skin.",
            {"inside": inside, "outside": outside, "flat_inside": flat_in,
             "flat_outside": flat_out, "border": border, "limit": limits["more"]},
        )  # fmt: skip


def flat_share(seen: Evidence) -> tuple[float, float]:
    """Share of blocks inside and off the mask that are like their neighbour: filled areas."""
    found = seen.gathered
    texels, where = found.texels, found.sure
    grid = np.full((*found.cover.shape, 3), np.nan, np.float32)
    grid[found.places[:, 0], found.places[:, 1]] = texels
    sure = np.zeros(found.cover.shape, bool)
    sure[found.places[:, 0], found.places[:, 1]] = where
    same = np.asarray(np.abs(np.diff(grid, axis=1)).max(axis=-1) < 1e-5)
    both_in, both_out = sure[:, 1:] & sure[:, :-1], ~sure[:, 1:] & ~sure[:, :-1]
    return (
        float(same[both_in].mean()) if both_in.any() else 0.0,
        float(same[both_out].mean()) if both_out.any() else 0.0,
    )


def border_cover(seen: Evidence) -> float:
    """Share of the picture's outermost texels that are inside the mask."""
    edges = [cover for _, cover in seen.gathered.edges]
    return float((np.concatenate(edges) > 0.5).mean())


def skin(seen: Evidence, limits: Limits) -> Iterator[Finding]:
    """How much of the mask has the colour of skin under any light."""
    if seen.gathered.tallies.inside < 1:
        return
    share = 1 - max(seen.share, seen.share_balanced)
    level = graded(share, limits["note"], limits["finding"])
    if level is not None:
        masked = "the mask" if seen.gathered.masked else "the picture"
        yield Finding(
            "not-skin", level,
            f"{percent(share)} of {masked} have a colour that is hardly one of skin, whatever the "
            "light.",
            "Mask hair, cloth and background out." if level == "note"
            else "Look whether this is an albedo of skin at all, and give --mask.",
            {"share": share, "note": limits["note"], "finding": limits["finding"]},
        )  # fmt: skip
