"""Seams between UDIM tiles: steps of colour across edges that two tiles share."""

from collections.abc import Iterator, Mapping

import numpy as np

from cutis.checks.finding import Finding
from cutis.checks.gathering import INSIDE, Gathered
from cutis.checks.thresholds import Limits
from cutis.colour import delta_e
from cutis.maps.plain import Map

FEWEST = 8
"""Places along an edge that are compared, at least."""
PLACES = 256
"""Places along an edge, at most."""


def check(tiles: Mapping[int, Gathered], limits: Limits) -> Iterator[tuple[int, Finding]]:
    """Findings of a set of tiles by number, each with the number of the tile it is said of."""
    for number, tile in tiles.items():
        column = (number - 1001) % 10
        if column < 9 and number + 1 in tiles:
            yield from _edge(number, number + 1, tile, tiles[number + 1], (1, 3), limits)
        if number + 10 in tiles:
            yield from _edge(number, number + 10, tile, tiles[number + 10], (0, 2), limits)


def _edge(
    one: int, other: int, a: Gathered, b: Gathered, sides: tuple[int, int], limits: Limits
) -> Iterator[tuple[int, Finding]]:
    step, share = edge_step(a.edges[sides[0]], b.edges[sides[1]], limits["alike"])
    if share >= limits["share"] and step >= limits["step"]:
        yield one, Finding(
            "seam", "finding",
            f"there is a seam to tile {other}: colours step by ΔE00 {step:.1f} across their shared "
            "edge.",
            "Give both tiles the same exposure and balance, and bake or paint across the edge.",
            {"step": step, "limit": limits["step"], "share": share},
        )  # fmt: skip


def edge_step(one: tuple[Map, Map], other: tuple[Map, Map], alike: float) -> tuple[float, float]:
    """ΔE00 of the usual step between two edges, and the share of them that can be compared.

    Edges go on in each other where both are covered and their courses are alike; islands that only
    happen to meet there differ by no common step, and are left out: 0, 0.
    """
    count = min(PLACES, len(one[1]), len(other[1]))
    (first, here), (second, there) = (_along(edge, count) for edge in (one, other))
    both = here & there
    if both.sum() < FEWEST:
        return 0.0, 0.0
    a, b = first[both], second[both]
    steps = np.log(np.maximum(a, 1e-4)) - np.log(np.maximum(b, 1e-4))
    usual = np.median(steps, axis=0)
    scatter = float(np.median(np.abs(steps - usual)))
    course = float(np.median(np.abs(np.log(np.maximum(a, 1e-4)) - np.log(
        np.maximum(np.median(a, axis=0), 1e-4)))))  # fmt: skip
    if scatter > max(alike, 0.7 * course):
        return 0.0, 0.0
    middle = np.median(b, axis=0)
    apart = delta_e((middle * np.exp(usual))[None], middle[None])
    return float(apart[0]), float(both.mean())


def _along(edge: tuple[Map, Map], count: int) -> tuple[Map, np.ndarray]:
    """Means of an edge at `count` places, and whether they are covered."""
    colours, cover = edge
    starts = np.arange(count) * len(cover) // count
    weight = np.add.reduceat(cover.astype(float), starts)
    total = np.add.reduceat(colours * cover[:, None].astype(float), starts, axis=0)
    size = np.diff(starts, append=len(cover))
    mean = np.asarray(total / np.maximum(weight, 1e-6)[:, None], np.float32)
    return mean, weight / size > INSIDE
