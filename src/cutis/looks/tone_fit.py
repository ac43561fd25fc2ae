"""How a face gets to another tone: what is found of it once, and solved for a target.

A face's colours vary along the path of people's tones, by light that is baked in, and aside of
both. Measured faces say how much the first and the last do (`tone_path`); what a face varies more
is light. A texel's degrees along the path are what explains it best (a Wiener filter), and are
blurred before they are used, so that pores and freckles ride along.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cutis.colour import ita
from cutis.colour.difference import to_relative_xyz
from cutis.errors import CutisError
from cutis.looks.tone_path import TonePath

Array = NDArray[np.float64]
Map = NDArray[np.float32]
SURE = 0.5
"""Confidence from which on a texel counts as skin."""
LIMIT = 2.5
"""Standard deviations of a face's tones beyond which differences grow slower."""
STRONGEST = 1.6
"""How much more, or less, strongly than measured ones a face's tones may be spread."""
ASIDE = 1.0
"""How far a face may be from the path, in standard deviations of people of its new tone."""
LIGHTEST = float(np.log(0.62))
"""Log red that no skin gets above."""
REDS = (2.0, 4.0)
"""Standard deviations of log R over G and B from which on a texel is as red as lips."""
LUMINANCE = np.array([0.21, 0.72, 0.07])
"""Of log RGB, about."""
BELOW_SKIN = 0.5
"""Log RGB that hair must be darker than the new skin around it."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Texels of a face: colours (n, 3), calibrated; confidence (n,); degrees along the path (n,).

    `areas` (m, 3) is log RGB of its areas, blurred.
    """

    colours: Map
    confidence: Map
    areas: Array
    degrees: Map | None = None

    @property
    def skin(self) -> NDArray[np.bool_]:
        """(n,) which texels are skin."""
        return np.asarray(self.confidence >= SURE)


@dataclass(frozen=True, eq=False)
class Spread:
    """What varies in a face: its median log RGB (3,) and ITA°, and the filter (`tone_kernel`)."""

    median: Array
    tone: float
    line: Array
    light: Array
    direction: Array
    deviation: float
    covariance: Array
    reds: Array

    @property
    def limit(self) -> float:
        """Degrees beyond which differences grow slower."""
        return LIMIT * self.deviation


@dataclass(frozen=True, eq=False)
class Goal:
    """Where to: ITA°, or a median colour (3,), log RGB, and the covariance of a face like it."""

    tone: float
    colour: Array | None = None
    covariance: Array | None = None


@dataclass(frozen=True, eq=False)
class Way:
    """The numbers that `tone_kernel.move` takes."""

    spread: Spread
    path: TonePath
    tone: float
    shift: Array
    aside: Array
    strength: float = 1.0
    mix: Array = field(default_factory=lambda: np.zeros((3, 3)))
    dark: Array = field(default_factory=lambda: np.zeros(3))
    along_path: bool = True

    @property
    def scale(self) -> float:
        """Of differences in CIELAB that are kept: they shrink with the cube root of what is dark.

        Those of darker people are no larger.
        """
        s = self.spread
        later = s.median + self.shift + self.path.colour(self.tone) - self.path.colour(s.tone)
        ratio = float(np.exp(LUMINANCE @ (later - s.median) / 3))
        return ratio * float(np.mean(self.aside))

    def __call__(self, colours: Map, confidence: Map, weights: Map, degrees: Map) -> Map:
        """Colours (h, W, 3) moved, `weights` (h, W) of the way."""
        from cutis.looks.tone_kernel import move

        s, path, out = self.spread, self.path, np.empty(colours.shape, np.float32)
        if not self.along_path:
            degrees = np.zeros_like(degrees)
        move(
            len(colours), colours, confidence, weights, degrees, s.median, s.line, s.light,
            s.direction, self.shift, self.aside, self.mix, path.colours, float(path.tones[0]),
            path.step, np.array([s.tone, self.tone]), self.strength, LIGHTEST, self.dark, s.reds,
            self.scale, to_relative_xyz(), np.linalg.inv(to_relative_xyz()), out,
        )  # fmt: skip
        return out


def spread_of(sample: Sample, path: TonePath) -> Spread:
    """What varies in a face; CutisError where nothing is skin."""
    skin = sample.skin
    if not skin.any():
        raise CutisError(
            "no texel of these maps is surely skin (confidence of at least 0.5), so that they have "
            "no tone to start from"
        )
    colours = sample.colours[skin]
    logs = np.log(np.maximum(colours, 2e-3)).astype(np.float64)
    median = np.median(logs, axis=0)
    tone = float(np.median(ita(colours)))
    d = logs - median
    width = np.maximum(1.4826 * np.median(np.abs(d), axis=0), 0.01)
    near = d[(np.abs(d) < 3 * width).all(axis=1)]
    found = np.cov(near.T) if len(near) > 3 else np.zeros((3, 3))
    direction, deviation = path.direction(tone), float(path.at(path.spread, tone))
    skins = deviation**2 * np.outer(direction, direction) + np.diag(path.aside(tone) ** 2)
    light = max(float(np.mean(np.diag(found) - np.diag(skins))), 0.05**2)
    inverse = np.linalg.inv(skins + light)
    line, shade = deviation**2 * direction @ inverse, light * np.ones(3) @ inverse
    red = d[:, 0] - 0.5 * (d[:, 1] + d[:, 2])
    usual = max(float(1.4826 * np.median(np.abs(red))), 0.03)
    return Spread(median, tone, line, shade, direction, deviation, found, np.array(REDS) * usual)


def solve(sample: Sample, spread: Spread, goal: Goal, path: TonePath, found: "Seen") -> Way:
    """The way of a face to a goal: its median is hit, its areas get the contrast of that tone.

    `found` says what colours (n, 3) look like once they are maps.
    """
    assert sample.degrees is not None
    skin = sample.skin
    way = _start(spread, goal, path)
    ones = np.ones((1, int(skin.sum())), np.float32)
    colours = np.ascontiguousarray(sample.colours[skin])[None]
    sure = sample.confidence[skin][None].astype(np.float32)
    degrees = np.ascontiguousarray(sample.degrees[skin])[None]
    wanted = path.contrast(goal.tone) / path.contrast(spread.tone)
    before = _contrast(sample.areas)
    for turn in range(24):
        moved = way(colours, sure, ones, degrees)[0]
        if turn >= 14:
            moved = found(moved)
        way = _corrected(way, goal, moved)
        if 2 < turn < 12 and goal.covariance is None and before > 0:
            ratio = _contrast(_moved_areas(way, sample.areas)) / before
            factor = float(np.clip((wanted / max(ratio, 1e-3)) ** 0.7, 0.5, 2))
            measured = float(path.at(path.spread, goal.tone) / path.at(path.spread, spread.tone))
            share = np.clip(way.strength / measured * factor, 1 / STRONGEST, STRONGEST)
            way = replace(way, strength=float(measured * share))
    return way


class Seen:
    """What colours (n, 3) become by a model: maps of them, and the colours of those."""

    def __init__(self, model) -> None:  # type: ignore[no-untyped-def]
        self._model = model

    def __call__(self, colours: Map) -> Map:
        """Colours (n, 3)."""
        return np.asarray(self._model.decode(self._model.encode(colours)))


def _start(spread: Spread, goal: Goal, path: TonePath) -> Way:
    off = spread.median - path.colour(spread.tone)
    between = path.at(path.between, goal.tone)
    small = 1e-5 * np.eye(3)
    kept = monge(path.at(path.between, spread.tone) + small, between + small) @ off
    far = float(np.sqrt(kept @ np.linalg.solve(between + 2e-4 * np.eye(3), kept)))
    kept = kept * min(1.0, ASIDE / max(far, 1e-6))
    aside = np.minimum(path.aside(goal.tone) / path.aside(spread.tone), 1.0)
    strength = float(path.at(path.spread, goal.tone) / path.at(path.spread, spread.tone))
    way = Way(spread, path, goal.tone, kept - off, aside, strength)
    if goal.covariance is not None:
        mix = monge(spread.covariance + small, goal.covariance + small) - np.eye(3)
        way = replace(way, mix=mix, aside=np.ones(3), along_path=False)
    return replace(way, dark=path.colour(goal.tone) - BELOW_SKIN)


def _corrected(way: Way, goal: Goal, moved: Map) -> Way:
    if goal.colour is None:
        return replace(way, tone=way.tone + goal.tone - float(np.median(ita(moved))))
    logs = np.log(np.maximum(np.median(moved, axis=0), 2e-3))
    return replace(way, shift=way.shift + goal.colour - logs)


def _moved_areas(way: Way, areas: Array) -> Array:
    """Log RGB of areas (m, 3) once they are moved."""
    s = way.spread
    raw = (areas - s.median) @ s.line
    degrees = raw / np.sqrt(1 + (raw / s.limit) ** 2)
    ones = np.ones((1, len(areas)), np.float32)
    colours = np.exp(areas).astype(np.float32)[None]
    moved = way(colours, ones, ones, degrees.astype(np.float32)[None])[0]
    return np.log(np.maximum(moved, 2e-3)).astype(np.float64)


def _contrast(areas: Array) -> float:
    return float(np.sqrt(np.var(areas, axis=0).sum())) if len(areas) > 1 else 0.0


def areas_of(sums: Array, counts: Array, sigma: float) -> Array:
    """Log RGB (m, 3) of areas where skin is: sums (h, w, 3) of log RGB over counts (h, w), blurred.

    `sigma` is in cells.
    """
    share = gaussian_filter(counts, sigma, mode="constant")
    total = gaussian_filter(sums, (sigma, sigma, 0), mode="constant")
    there = counts > 0.5 * max(float(counts.max()), 1.0)
    return np.asarray(total[there] / share[there][:, None])


def monge(start: Array, end: Array) -> Array:
    """The symmetric matrix (3, 3) that gives what varies by one covariance the other."""
    root = _root(start)
    inverse = np.linalg.inv(root)
    return np.asarray(inverse @ _root(root @ end @ root) @ inverse)


def _root(matrix: Array) -> Array:
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray((vectors * np.sqrt(np.maximum(values, 1e-12))) @ vectors.T)
